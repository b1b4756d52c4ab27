#include "ui/session/provenance.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>

#include <CLI/Version.hpp>
#include <fmt/format.h>
#include <gnu/libc-version.h>
#include <link.h>
#include <png.h>
#include <sys/utsname.h>

#include "engine/base/text.hpp"
#include "protocols/file/document.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/verify/verify.hpp"
#include "ui/sdl/sdl.hpp"

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
            return std::string(trimmed(std::string_view(line).substr(at + 1), " \t\""));
        }
    }
    return "unknown";
}

constexpr std::uint32_t kBuildId = 3;  // NT_GNU_BUILD_ID of a note named "GNU"
constexpr std::string_view kGnu{"GNU\0", 4};

std::size_t padded(std::size_t size) {
    return (size + 3U) & ~std::size_t{3};
}

/// The build id among the notes of a segment; empty: it is not there.
std::string find_id(const unsigned char* at, std::size_t size) {
    while (size >= sizeof(Elf64_Nhdr)) {
        Elf64_Nhdr note{};
        std::memcpy(&note, at, sizeof note);
        const std::size_t name = sizeof note;
        const std::size_t text = name + padded(note.n_namesz);
        const std::size_t next = text + padded(note.n_descsz);
        if (next > size) {
            break;
        }
        if (note.n_type == kBuildId && note.n_namesz == kGnu.size() &&
            std::memcmp(at + name, kGnu.data(), kGnu.size()) == 0) {
            return fmt::format("{:02x}", fmt::join(at + text, at + text + note.n_descsz, ""));
        }
        at += next;
        size -= next;
    }
    return {};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> provenance(const protocols::Protocol& protocol) {
    utsname system{};
    uname(&system);
    std::vector<std::pair<std::string, std::string>> rows{
        {"palpate", PALPATE_VERSION},
        {"build id", build_id()},
        {"compiler", __VERSION__},
        {"libc", gnu_get_libc_version()},
        {"fmt", fmt_version()},
        {"toml++", protocols::toml_version()},
        {"CLI11", CLI11_VERSION},
        {"libpng", png_get_libpng_ver(nullptr)},
        {"system", line_of("/etc/os-release", "PRETTY_NAME=", '=')},
        {"kernel", std::string(system.sysname) + " " + system.release},
        {"machine", system.machine},
        {"processor", line_of("/proc/cpuinfo", "model name", ':')}};
    if (SDL_Init.called()) {  // there is a screen
        rows.emplace_back("SDL2", sdl_version());
        rows.emplace_back("SDL2_ttf", text_of(*TTF_Linked_Version()));
    }
    const auto of_data = data::library_versions();
    rows.insert(rows.end(), of_data.begin(), of_data.end());
    const auto objects = protocols::object_hashes(protocol);
    rows.insert(rows.end(), objects.begin(), objects.end());
    return rows;
}

std::string build_id() {
    std::string id = "unknown";
    const auto look = [](dl_phdr_info* program, std::size_t /*size*/, void* found) {
        for (std::size_t i = 0; i < program->dlpi_phnum; ++i) {
            const Elf64_Phdr& notes = program->dlpi_phdr[i];
            const auto* at =
                reinterpret_cast<const unsigned char*>(program->dlpi_addr + notes.p_vaddr);
            if (std::string one = notes.p_type == PT_NOTE ? find_id(at, notes.p_memsz) : "";
                !one.empty()) {
                *static_cast<std::string*>(found) = std::move(one);
                break;
            }
        }
        return 1;  // the program itself comes first, and no library is asked
    };
    dl_iterate_phdr(look, &id);
    return id;
}

}  // namespace palpate::ui
