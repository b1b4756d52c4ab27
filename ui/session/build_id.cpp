#include "ui/session/build_id.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <sys/auxv.h>  // and elf.h

namespace palpate::ui {
namespace {

constexpr std::uint32_t kBuildId = 3;  // NT_GNU_BUILD_ID of a note named "GNU"
constexpr std::string_view kGnu{"GNU\0", 4};

std::size_t padded(std::size_t size) {
    return (size + 3U) & ~std::size_t{3};
}

std::string hexadecimal(const unsigned char* bytes, std::size_t size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) {
        text += fmt::format("{:02x}", static_cast<unsigned>(bytes[i]));
    }
    return text;
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
            return hexadecimal(at + text, note.n_descsz);
        }
        at += next;
        size -= next;
    }
    return {};
}

}  // namespace

std::string build_id() {
    // The kernel tells where it put the program's headers (getauxval(3)); they say where the notes
    // are.
    const auto* headers = reinterpret_cast<const unsigned char*>(getauxval(AT_PHDR));
    const std::size_t count = getauxval(AT_PHNUM);
    std::uintptr_t base = 0;
    const auto header = [headers](std::size_t i) {
        Elf64_Phdr one{};
        std::memcpy(&one, headers + i * sizeof one, sizeof one);
        return one;
    };
    for (std::size_t i = 0; headers != nullptr && i < count; ++i) {
        if (header(i).p_type == PT_PHDR) {
            base = reinterpret_cast<std::uintptr_t>(headers) - header(i).p_vaddr;
        }
    }
    for (std::size_t i = 0; headers != nullptr && i < count; ++i) {
        const Elf64_Phdr notes = header(i);
        if (notes.p_type == PT_NOTE) {
            const auto* at = reinterpret_cast<const unsigned char*>(base + notes.p_vaddr);
            if (std::string id = find_id(at, notes.p_memsz); !id.empty()) {
                return id;
            }
        }
    }
    return "unknown";
}

}  // namespace palpate::ui
