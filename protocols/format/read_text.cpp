#include "protocols/format/read_text.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "protocols/format/protocol_file.hpp"

namespace palpate::protocols {

std::string read_text(const std::filesystem::path& file) {
    const auto unreadable = [&](const std::string& why) {
        return ProtocolError(
            fmt::format("{}:1:1: cannot be read: {}; check the path", file.string(), why));
    };
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) {
        throw unreadable("it is a folder");
    }
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) {
        throw unreadable(std::generic_category().message(errno));
    }
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad()) {
        throw unreadable(std::generic_category().message(errno));
    }
    return text;
}

}  // namespace palpate::protocols
