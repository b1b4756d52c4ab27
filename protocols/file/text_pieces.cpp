#include "protocols/file/text_pieces.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

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

ProtocolError unreadable(const std::string& file, const std::string& why) {
    return ProtocolError(fmt::format("{}:1:1: cannot be read: {}; check the path", file, why));
}

}  // namespace

TextPieces::TextPieces(const std::filesystem::path& file, std::size_t max)
    : file_(file.string()), max_(max) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw unreadable(file_, "it is a folder");
    }
    fd_ = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (fd_ < 0) {
        throw unreadable(file_, std::generic_category().message(errno));
    }
}

TextPieces::~TextPieces() {
    if (fd_ >= 0) {
        ::close(fd_);
    }
}

bool TextPieces::next(std::string& text) {
    const std::size_t before = text.size();
    for (bool end = false; !end && text.size() == before;) {
        if (const std::string why = read_more(fd_, text, end); !why.empty()) {
            throw unreadable(file_, why);
        }
    }
    read_ += text.size() - before;
    if (read_ > max_) {
        throw unreadable(file_, fmt::format("it is longer than {} bytes", max_));
    }
    return text.size() > before;
}

}  // namespace palpate::protocols
