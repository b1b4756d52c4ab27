#include "protocols/file/read_text.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "protocols/file/protocol_file.hpp"

namespace palpate::protocols {
namespace {

constexpr int kPatienceMs = 10'000;

/// The next bytes, appended to `text`. @return why there are none, empty at the end or after some
std::string read_more(int fd, std::string& text, bool& end) {
    pollfd one{.fd = fd, .events = POLLIN, .revents = 0};
    const int ready = poll(&one, 1, kPatienceMs);
    if (ready == 0) {
        return "nothing has come out of it for 10 s";
    }
    constexpr std::size_t kPiece = std::size_t{1} << 16U;
    const std::size_t before = text.size();
    text.resize(before + kPiece);
    const ssize_t got = ready < 0 ? -1 : ::read(fd, text.data() + before, kPiece);
    text.resize(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
    end = got == 0;
    return got >= 0 || errno == EINTR || errno == EAGAIN ? ""
                                                         : std::generic_category().message(errno);
}

std::string read_all(int fd, std::size_t most, std::string& text) {
    for (bool end = false; !end;) {
        std::string why = read_more(fd, text, end);
        if (!why.empty()) {
            return why;
        }
        if (text.size() > most) {
            return fmt::format("it is longer than {} bytes", most);
        }
    }
    return {};
}

}  // namespace

std::string read_text(const std::filesystem::path& file, std::size_t most) {
    const auto unreadable = [&](const std::string& why) {
        return ProtocolError(
            fmt::format("{}:1:1: cannot be read: {}; check the path", file.string(), why));
    };
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw unreadable("it is a folder");
    }
    const int fd = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd < 0) {
        throw unreadable(std::generic_category().message(errno));
    }
    std::string text;
    const std::string why = read_all(fd, most, text);
    ::close(fd);
    if (!why.empty()) {
        throw unreadable(why);
    }
    return text;
}

}  // namespace palpate::protocols
