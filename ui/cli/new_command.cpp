#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "protocols/format/keys.hpp"
#include "protocols/library/new_protocol.hpp"
#include "ui/cli/commands.hpp"

namespace palpate::ui {
namespace {

/// Only a file that is not there: an experimenter's protocol is never overwritten, whoever comes first.
void write_new(const std::string& file, const std::string& text) {
    std::FILE* stream = std::fopen(file.c_str(), "wx");
    if (stream == nullptr) {
        const int error = errno;
        if (error == EEXIST) {
            throw std::invalid_argument(
                fmt::format("{} is there already, and stays as it is: give another name", file));
        }
        throw std::invalid_argument(fmt::format("{} cannot be written: {}; check the path", file,
                                                std::generic_category().message(error)));
    }
    const bool whole = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    if ((std::fclose(stream) != 0) || !whole) {
        std::remove(file.c_str());
        throw std::runtime_error(
            fmt::format("{} could not be written whole: is the disk full?", file));
    }
}

}  // namespace

int new_command(const NewOptions& options) {
    if (options.keys) {
        fmt::print("{}", protocols::key_reference());
        return 0;
    }
    const std::string id = protocols::id_of(std::filesystem::path(options.file).stem().string());
    write_new(options.file, new_protocol(protocols::shipped_protocol(options.from), id));
    fmt::print("{}: a study with the id {}, made from {}\nNext: palpate check {}\n", options.file,
               id, options.from, options.file);
    return 0;
}

}  // namespace palpate::ui
