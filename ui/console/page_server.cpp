#include "ui/console/page_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "engine/base/refuse.hpp"
#include "engine/base/shared_library.hpp"
#include "data/store/uuid.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/json_line.hpp"

namespace palpate::ui {
namespace {

/// Loaded with the first page: it brings TLS, which no other command needs.
struct Microhttpd {
    static constexpr const char* kFile = "libmicrohttpd.so.12";
    static constexpr const char* kUse = "a page needs libmicrohttpd";
    static constexpr const char* kPackage = "libmicrohttpd12";
};
PALPATE_LATE(Microhttpd, MHD_add_response_header);
PALPATE_LATE(Microhttpd, MHD_create_response_from_buffer);
PALPATE_LATE(Microhttpd, MHD_create_response_from_callback);
PALPATE_LATE(Microhttpd, MHD_destroy_response);
PALPATE_LATE(Microhttpd, MHD_get_connection_info);
PALPATE_LATE(Microhttpd, MHD_get_connection_values);
PALPATE_LATE(Microhttpd, MHD_get_daemon_info);
PALPATE_LATE(Microhttpd, MHD_lookup_connection_value);
PALPATE_LATE(Microhttpd, MHD_queue_response);
PALPATE_LATE(Microhttpd, MHD_start_daemon);
PALPATE_LATE(Microhttpd, MHD_stop_daemon);

constexpr unsigned kConnections = 64;
constexpr std::size_t kStrangers = 16;  ///< of them, but for those that are being let go
constexpr std::size_t kConnectionMemory = 32768;
constexpr unsigned kSilence = 15;  ///< s

constexpr std::array<std::pair<const char*, const char*>, 8> kHeaders{{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' "
     "data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cache-Control", "no-store"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Permissions-Policy", "camera=(), microphone=(), geolocation=()"},
}};

/// In a time that says nothing of where they differ.
bool same_secret(std::string_view given, std::string_view secret) {
    unsigned differs = given.size() == secret.size() ? 0U : 1U;
    for (std::size_t i = 0; i < secret.size(); ++i) {
        differs |= static_cast<unsigned>(secret[i]) ^
                   static_cast<unsigned>(i < given.size() ? given[i] : 0);
    }
    return differs == 0;
}

int socket_of(MHD_Connection* connection) {
    return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

std::string_view value_of(MHD_Connection* connection, MHD_ValueKind kind, const char* key) {
    const char* value = MHD_lookup_connection_value(connection, kind, key);
    return value == nullptr ? std::string_view() : std::string_view(value);
}

/// How often a key came: two Hosts are nobody's.
std::size_t times(MHD_Connection* connection, const char* key) {
    std::pair<const char*, std::size_t> count{key, 0};
    MHD_get_connection_values(
        connection, MHD_HEADER_KIND,
        [](void* at, MHD_ValueKind, const char* name, const char*) {
            auto& [wanted, seen] = *static_cast<decltype(count)*>(at);
            seen += strcasecmp(name, wanted) == 0 ? 1U : 0U;
            return MHD_YES;
        },
        &count);
    return count.second;
}

const char* type_of(std::string_view path) {
    constexpr std::array<std::pair<std::string_view, const char*>, 4> kTypes{{
        {".css", "text/css; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
    }};
    const auto* found =
        std::ranges::find_if(kTypes, [&](const auto& type) { return path.ends_with(type.first); });
    return found == kTypes.end() ? "text/html; charset=utf-8" : found->second;
}

struct Stream {
    EventSource source;
    const std::atomic<bool>& ends;
    std::string waiting{};
    std::int64_t asked_ns = 0;
};

ssize_t read_stream(void* at, std::uint64_t /*from*/, char* bytes, std::size_t room) {
    auto& stream = *static_cast<Stream*>(at);
    try {
        while (stream.waiting.empty()) {
            sleep_until(stream.asked_ns + PageServer::kPace);
            stream.asked_ns = monotonic_ns();
            auto news = stream.ends ? std::nullopt : stream.source();
            if (!news) {
                return MHD_CONTENT_READER_END_OF_STREAM;
            }
            stream.waiting = *std::move(news);
        }
    } catch (const std::exception&) {
        return MHD_CONTENT_READER_END_WITH_ERROR;
    }
    const std::size_t part = std::min(room, stream.waiting.size());
    std::memcpy(bytes, stream.waiting.data(), part);
    stream.waiting.erase(0, part);
    return static_cast<ssize_t>(part);
}

}  // namespace

/// Who is connected, and did not show the cookie. Of more than some the first makes room.
class PageServer::Strangers {
public:
    static void notified(void* at,
                         MHD_Connection* who,
                         void** /*own*/,
                         MHD_ConnectionNotificationCode what) {
        auto& self = *static_cast<Strangers*>(at);
        try {
            what == MHD_CONNECTION_NOTIFY_STARTED ? self.comes(who) : self.forget(who);
        } catch (const std::exception&) {  // no memory: it is no stranger, and stays
        }
    }
    /// It left, or is no stranger any more.
    void forget(MHD_Connection* who) {
        const std::scoped_lock lock(mutex_);
        std::erase_if(all_, [&](const auto& one) { return one.first == who; });
    }

private:
    void comes(MHD_Connection* who) {
        const std::scoped_lock lock(mutex_);
        all_.emplace_back(who, Descriptor(fcntl(socket_of(who), F_DUPFD_CLOEXEC, 0)));
        if (all_.size() > kStrangers) {
            shutdown(all_.front().second.get(), SHUT_RDWR);  // its thread lets it go
            all_.pop_front();
        }
    }

    std::mutex mutex_;
    std::deque<std::pair<MHD_Connection*, Descriptor>> all_;  ///< who came first first
};

/// One request, from its head to its answer.
struct PageRequest {
    PageServer& server;
    MHD_Connection* connection;
    std::string body{};
    bool too_long = false;

    [[nodiscard]] MHD_Result answer(unsigned code,
                                    std::string_view text,
                                    const char* type = "text/plain; charset=utf-8") const {
        return queue(code, response_of(text), type);
    }
    [[nodiscard]] static MHD_Response* response_of(std::string_view text) {
        return MHD_create_response_from_buffer(text.size(), const_cast<char*>(text.data()),
                                               MHD_RESPMEM_MUST_COPY);  // NOLINT: copied
    }
    [[nodiscard]] MHD_Result queue(unsigned code, MHD_Response* response, const char* type) const {
        MHD_add_response_header(response, "Content-Type", type);
        for (const auto& [key, value] : kHeaders) {
            MHD_add_response_header(response, key, value);
        }
        const MHD_Result queued = MHD_queue_response(connection, code, response);
        MHD_destroy_response(response);
        return queued;
    }

    /// Whoever asks came by this server's own name, and from its own page or by hand.
    [[nodiscard]] bool comes_from_here(bool acts) const {
        const std::string_view host = value_of(connection, MHD_HEADER_KIND, "Host");
        const bool here = host == server.host_ || (server.spec_.address == PageServerSpec::kHere &&
                                                   host == "localhost:" + server.port_);
        const std::string_view origin = value_of(connection, MHD_HEADER_KIND, "Origin");
        const std::string own =
            fmt::format("{}://{}", server.spec_.certificate.empty() ? "http" : "https", host);
        return here && times(connection, "Host") == 1 && times(connection, "Origin") <= 1 &&
               (origin.empty() ? !acts : origin == own);
    }

    [[nodiscard]] MHD_Result trade() const {
        const std::string_view token = value_of(connection, MHD_GET_ARGUMENT_KIND, "token");
        if (!same_secret(token, server.spec_.token)) {
            return answer(MHD_HTTP_FORBIDDEN, "not the token of this page\n");
        }
        const std::string cookie =
            fmt::format("palpate_{}={}; HttpOnly; SameSite=Strict; Path=/{}", server.port_,
                        server.spec_.cookie, server.spec_.certificate.empty() ? "" : "; Secure");
        MHD_Response* response = response_of("");
        MHD_add_response_header(response, "Location", "/");
        MHD_add_response_header(response, "Set-Cookie", cookie.c_str());
        return queue(MHD_HTTP_SEE_OTHER, response, "text/plain");
    }

    [[nodiscard]] MHD_Result get(std::string_view path) const {
        if (path == "/favicon.ico") {
            return answer(MHD_HTTP_NO_CONTENT, "", "image/x-icon");
        }
        if (path == "/stream") {
            const auto asks = [&](const char* key) {
                return !value_of(connection, MHD_GET_ARGUMENT_KIND, key).empty();
            };
            auto* stream =
                new Stream{server.spec_.open(asks("shown"), asks("still")), server.ends_};
            MHD_Response* response = MHD_create_response_from_callback(
                MHD_SIZE_UNKNOWN, 16384, &read_stream, stream,
                [](void* at) { delete static_cast<Stream*>(at); });  // NOLINT: as above
            return queue(MHD_HTTP_OK, response, "text/event-stream");
        }
        const std::string file = server.spec_.file(path);
        return file.empty() ? answer(MHD_HTTP_NOT_FOUND, "there is no such page\n")
                            : answer(MHD_HTTP_OK, file, type_of(path));
    }

    [[nodiscard]] MHD_Result act() const {
        constexpr const char* kJson = "application/json";
        if (!server.spec_.act) {
            return answer(MHD_HTTP_FORBIDDEN,
                          answer_of(false, "this page may only look: --act lets it act"), kJson);
        }
        if (too_long || value_of(connection, MHD_HEADER_KIND, "Content-Type") != kJson) {
            return answer(MHD_HTTP_BAD_REQUEST, answer_of(false, "one short JSON object is taken"),
                          kJson);
        }
        pollfd other_end{.fd = socket_of(connection), .events = POLLRDHUP, .revents = 0};
        return answer(MHD_HTTP_OK, server.spec_.act(body, poll(&other_end, 1, 0) > 0), kJson);
    }

    [[nodiscard]] MHD_Result handle(std::string_view method, std::string_view path) const {
        const bool acts = method == "POST" && path == "/do";
        if (!acts && method != "GET") {
            return answer(MHD_HTTP_METHOD_NOT_ALLOWED, "not here\n");
        }
        if (!comes_from_here(acts)) {
            return answer(MHD_HTTP_FORBIDDEN, "not from this page\n");
        }
        if (!acts && path == "/" &&
            MHD_lookup_connection_value(connection, MHD_GET_ARGUMENT_KIND, "token") != nullptr) {
            return trade();
        }
        const std::string_view cookie =
            value_of(connection, MHD_COOKIE_KIND, ("palpate_" + server.port_).c_str());
        if (!same_secret(cookie, server.spec_.cookie)) {
            return answer(MHD_HTTP_FORBIDDEN, "open the address that palpate console printed\n");
        }
        server.strangers_->forget(connection);
        return acts ? act() : get(path);
    }

    static MHD_Result heard(void* at,
                            MHD_Connection* connection,
                            const char* url,
                            const char* method,
                            const char* /*version*/,
                            const char* upload,
                            std::size_t* upload_size,
                            void** request) {
        try {
            if (*request == nullptr) {
                *request = new PageRequest{*static_cast<PageServer*>(at),
                                           connection};  // NOLINT: completed()
                return MHD_YES;
            }
            auto& self = *static_cast<PageRequest*>(*request);
            if (*upload_size > 0) {
                self.too_long |= self.body.size() + *upload_size > PageServer::kLongestBody;
                if (!self.too_long) {
                    self.body.append(upload, *upload_size);
                }
                *upload_size = 0;
                return MHD_YES;
            }
            return self.handle(method, url);
        } catch (const std::exception&) {  // the connection is closed
            return MHD_NO;
        }
    }
    static void completed(void* /*at*/,
                          MHD_Connection* /*connection*/,
                          void** request,
                          MHD_RequestTerminationCode /*why*/) {
        delete static_cast<PageRequest*>(*request);  // NOLINT: of heard()
        *request = nullptr;
    }
};

PageServer::PageServer(PageServerSpec spec)
    : spec_(std::move(spec)), strangers_(std::make_unique<Strangers>()) {
    for (std::string* secret : {&spec_.token, &spec_.cookie}) {
        *secret = secret->empty() ? data::random_secret() : *secret;
    }
    sockaddr_in where{};
    where.sin_family = AF_INET;
    const std::string no_address = fmt::format(
        "{} is no IPv4 address of this machine, such as 192.168.1.5; hostname -I lists "
        "its addresses",
        spec_.address);
    refuse_if(inet_pton(AF_INET, spec_.address.c_str(), &where.sin_addr) != 1 ||
                  where.sin_addr.s_addr == INADDR_ANY,
              "{}", no_address);
    const bool tls = !spec_.certificate.empty();
    refuse_if(!tls && spec_.address != PageServerSpec::kHere,
              "{}: only by TLS, with a certificate and its key", spec_.address);
    if (spec_.listening.get() < 0) {
        spec_.listening = listening_at(where.sin_addr.s_addr);
        refuse_if<std::runtime_error>(spec_.listening.get() < 0, "{}",
                                      errno == EADDRNOTAVAIL
                                          ? no_address
                                          : fmt::format("a page cannot be served at {}: {}",
                                                        spec_.address, std::strerror(errno)));
    }
    // Whoever waits there is answered before MHD_start_daemon() returns.
    socklen_t length = sizeof where;
    getsockname(spec_.listening.get(), reinterpret_cast<sockaddr*>(&where), &length);  // NOLINT
    port_ = std::to_string(ntohs(where.sin_port));
    host_ = spec_.address + ":" + port_;
    // Without ITC its end would shut the listening socket down for every server of the session.
    const unsigned flags = MHD_USE_THREAD_PER_CONNECTION | MHD_USE_INTERNAL_POLLING_THREAD |
                           MHD_USE_POLL | MHD_USE_ITC | (tls ? unsigned{MHD_USE_TLS} : 0U);
    const MHD_OptionItem certificates[]{{MHD_OPTION_HTTPS_MEM_CERT, 0, spec_.certificate.data()},
                                        {MHD_OPTION_HTTPS_MEM_KEY, 0, spec_.key.data()},
                                        {MHD_OPTION_END, 0, nullptr}};
    daemon_ = MHD_start_daemon(
        flags, 0, nullptr, nullptr, &PageRequest::heard, this, MHD_OPTION_LISTEN_SOCKET,
        fcntl(spec_.listening.get(), F_DUPFD_CLOEXEC, 0), MHD_OPTION_SOCK_ADDR, &where,
        MHD_OPTION_NOTIFY_COMPLETED, &PageRequest::completed, nullptr, MHD_OPTION_NOTIFY_CONNECTION,
        &Strangers::notified, strangers_.get(), MHD_OPTION_CONNECTION_LIMIT, kConnections,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionMemory, MHD_OPTION_CONNECTION_TIMEOUT,
        kSilence, MHD_OPTION_ARRAY, tls ? certificates : certificates + 2, MHD_OPTION_END);
    refuse_if<std::runtime_error>(
        daemon_ == nullptr, "{}",
        tls ? std::string("the key is not that of the certificate, or one of them is no whole PEM")
            : fmt::format("a page cannot be served at {}", spec_.address));
}

PageServer::~PageServer() {
    ends_ = true;
    MHD_stop_daemon(daemon_);
}

std::string PageServer::address() const {
    return fmt::format("{}://{}/?token={}", spec_.certificate.empty() ? "http" : "https", host_,
                       spec_.token);
}

}  // namespace palpate::ui
