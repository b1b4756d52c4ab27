#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "engine/base/clock.hpp"
#include "tests/support/process.hpp"

namespace palpate::tests {

/// One connection to a server on this machine.
class HttpLine {
public:
    explicit HttpLine(std::uint16_t port)
        : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        open_ = connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
    }
    HttpLine(const HttpLine&) = delete;
    HttpLine& operator=(const HttpLine&) = delete;
    ~HttpLine() { close(socket_); }

    void say(std::string_view text) const {
        static_cast<void>(send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
    }
    /// What has come until `text` is in it, nothing more comes, or the seconds are over.
    const std::string& hear_until(std::string_view text, int seconds = 50) {
        const std::int64_t end = monotonic_ns() + seconds * 1000 * kMillisecond;
        std::string piece(65536, '\0');
        while (open_ && heard_.find(text) == std::string::npos && monotonic_ns() < end) {
            pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
            if (poll(&one, 1, 100) > 0) {
                const ssize_t got = recv(socket_, piece.data(), piece.size(), 0);
                open_ = got > 0;
                heard_.append(piece, 0, static_cast<std::size_t>(got > 0 ? got : 0));
            }
        }
        return heard_;
    }
    [[nodiscard]] const std::string& heard() const { return heard_; }
    void forget() { heard_.clear(); }

private:
    int socket_;
    bool open_ = false;
    std::string heard_;
};

/// Asks the page of a `palpate console` as a browser would, or as one should not.
class Browser {
public:
    /// @param said  by the program: its address with the token
    explicit Browser(const std::string& said) {
        const std::size_t at = said.find("http://127.0.0.1:") + 17;
        port = static_cast<std::uint16_t>(std::stoi(said.substr(at)));
        token = said.substr(said.find("?token=") + 7, 32);
        host = "127.0.0.1:" + std::to_string(port);
    }
    /// @return status line, head and body
    [[nodiscard]] std::string get(const std::string& path, const std::string& more = {}) const {
        return ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" + more);
    }
    [[nodiscard]] std::string act(const std::string& body, const std::string& more) const {
        return ask("POST /do HTTP/1.1\r\nHost: " + host +
                       "\r\nContent-Type: application/json\r\nContent-Length: " +
                       std::to_string(body.size()) + "\r\n" + more,
                   body);
    }
    /// As the page does it, once its token was traded.
    [[nodiscard]] std::string act(const std::string& body) const {
        return act(body, cookie + origin());
    }
    [[nodiscard]] std::string ask(const std::string& head, const std::string& body = {}) const {
        HttpLine line(port);
        line.say(head + "Connection: close\r\n\r\n" + body);
        return line.hear_until(std::string_view("\0\1", 2));
    }
    /// Trades the token. @return the head that shows it was
    std::string trade() {
        const std::string answer = get("/?token=" + token);
        const std::size_t at = answer.find("Set-Cookie: ") + 12;
        cookie = "Cookie: " + answer.substr(at, answer.find(';', at) - at) + "\r\n";
        return answer;
    }
    /// Asks for the stream with the cookie.
    [[nodiscard]] std::unique_ptr<HttpLine> stream(const std::string& query = {}) const {
        auto line = std::make_unique<HttpLine>(port);
        line->say("GET /stream" + query + " HTTP/1.1\r\nHost: " + host + "\r\n" + cookie + "\r\n");
        return line;
    }
    [[nodiscard]] std::string origin() const { return "Origin: http://" + host + "\r\n"; }

    std::uint16_t port = 0;
    std::string token;
    std::string host;
    std::string cookie;
};

}  // namespace palpate::tests
