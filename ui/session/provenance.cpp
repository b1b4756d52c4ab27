#include "ui/session/provenance.hpp"

#include <fstream>
#include <string_view>

#include <CLI/Version.hpp>
#include <SDL2/SDL.h>
#include <SDL2/SDL_ttf.h>
#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <png.h>
#include <sys/utsname.h>

#include "protocols/file/document.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/verify/verify.hpp"
#include "ui/session/build_id.hpp"
#include "ui/session/version.hpp"

namespace palpate::ui {
namespace {

std::string text_of(const SDL_version& version) {
    return fmt::format("{}.{}.{}", version.major, version.minor, version.patch);
}

std::string sdl_version() {
    SDL_version version{};
    SDL_GetVersion(&version);
    return text_of(version);
}

std::string fmt_version() {
    return fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
}

/// What follows `key` and `separator` in the first line of a file that begins with the key.
std::string line_of(const char* file, std::string_view key, char separator) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        const std::size_t at = line.find(separator);
        if (line.starts_with(key) && at != std::string::npos) {
            std::string value = line.substr(at + 1);
            value.erase(0, value.find_first_not_of(" \t\""));
            value.erase(value.find_last_not_of(" \t\"") + 1);
            return value;
        }
    }
    return "unknown";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance() {
    utsname system{};
    uname(&system);
    std::vector<std::pair<std::string, std::string>> rows{
        {"palpate", kVersion},
        {"build id", build_id()},
        {"compiler", __VERSION__},
        {"libc", gnu_get_libc_version()},
        {"fmt", fmt_version()},
        {"toml++", protocols::toml_version()},
        {"CLI11", CLI11_VERSION},
        {"SDL2", sdl_version()},
        {"SDL2_ttf", text_of(*TTF_Linked_Version())},
        {"libpng", png_get_libpng_ver(nullptr)},
        {"system", line_of("/etc/os-release", "PRETTY_NAME=", '=')},
        {"kernel", std::string(system.sysname) + " " + system.release},
        {"machine", system.machine},
        {"processor", line_of("/proc/cpuinfo", "model name", ':')}};
    const auto of_data = data::library_versions();
    rows.insert(rows.end(), of_data.begin(), of_data.end());
    return rows;
}

std::vector<std::pair<std::string, std::string>> provenance(const protocols::Protocol& protocol) {
    auto rows = provenance();
    const auto objects = protocols::object_hashes(protocol);
    rows.insert(rows.end(), objects.begin(), objects.end());
    return rows;
}

}  // namespace palpate::ui
