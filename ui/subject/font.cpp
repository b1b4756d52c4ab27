#include "ui/subject/font.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "ui/sdl/sdl.hpp"

namespace palpate::ui {
namespace {

constexpr const char* kFonts[] = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
};

/// A font that is open beside windows, or without one.
class OpenFont {
public:
    explicit OpenFont(const std::string& file) {
        static_cast<void>(TTF_Init());  // counted
        font_ = TTF_OpenFont(file.c_str(), 8);
        if (font_ == nullptr) {
            trouble_ = TTF_GetError();
        }
    }
    OpenFont(const OpenFont&) = delete;
    OpenFont& operator=(const OpenFont&) = delete;
    ~OpenFont() {
        if (font_ != nullptr) {
            TTF_CloseFont(font_);
        }
        TTF_Quit();
    }
    [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }
    [[nodiscard]] bool has(char32_t code) const noexcept {
        return TTF_GlyphIsProvided32(font_, code) != 0;
    }

private:
    TTF_Font* font_ = nullptr;
    std::string trouble_;  ///< empty: it is open
};

/// Hebrew, Arabic, Syriac, Thaana, N'Ko and their like, as Unicode keeps them together.
bool is_from_right(char32_t code) noexcept {
    constexpr std::pair<char32_t, char32_t> kScripts[] = {
        {0x590, 0x8FF}, {0xFB1D, 0xFDFF}, {0xFE70, 0xFEFC}, {0x10800, 0x10FFF}, {0x1E800, 0x1EFFF}};
    return std::ranges::any_of(kScripts, [code](const auto& script) {
        return code >= script.first && code <= script.second;
    });
}

}  // namespace

std::string find_font(const std::string& asked) {
    if (!asked.empty()) {
        std::error_code no;
        refuse_if(!std::filesystem::is_regular_file(asked, no), "--font {}: there is no such file",
                  asked);
        // Opened once: a file of another kind would end the window that was to show it.
        const std::string why = OpenFont(asked).trouble();
        refuse_if(!why.empty(), "--font {}: this is no font that opens ({}): give a TrueType file",
                  asked, why);
        return asked;
    }
    for (const char* file : kFonts) {
        if (std::filesystem::exists(file)) {
            return file;
        }
    }
    throw std::runtime_error(
        "the font DejaVu Sans is not installed: install fonts-dejavu-core, or give --font FILE");
}

Unshown unshown(std::string_view text, const std::string& file) {
    const OpenFont font(file);
    refuse_if<std::runtime_error>(!font.trouble().empty(), "{}: {}", file, font.trouble());
    Unshown found;
    while (!text.empty()) {
        const auto [code, length] = first_character(text);
        const std::size_t whole = std::max<std::size_t>(length, 1);
        const bool from_right = is_from_right(code);
        std::string& first = from_right ? found.from_right : found.lacking;
        if (first.empty() && code > 0x20 && (from_right || !font.has(code))) {
            first = text.substr(0, whole);
        }
        text.remove_prefix(whole);
    }
    return found;
}

}  // namespace palpate::ui
