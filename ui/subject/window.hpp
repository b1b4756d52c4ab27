#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/geometry/vec.hpp"
#include "ui/subject/words.hpp"

struct SDL_Window;
namespace palpate::ui {

/// Opaque colour, 0 to 255.
struct Colour {
    std::uint8_t r = 0;
    std::uint8_t g = 0;
    std::uint8_t b = 0;
};

/// A corner of a triangle: pixels from the top left, and how much of the colour it carries, 0 to 1.
struct Corner {
    engine::Vec2 position{};
    float cover = 1.0F;
};

enum class Align { left, centre, right };

/// A line of text that stands in the window.
struct TextExtent {
    std::string text;
    engine::Vec2 corner{};  ///< top left, pixels
    engine::Vec2 size{};
};

/// Where a window opens, and how large.
struct WindowOptions {
    bool fullscreen = false;
    int monitor = 0;   ///< 1 and up, as FoundDisplay::monitors has them; 0: the first one
    int width = 0;     ///< of a window that is not full screen; 0: what suits the display, within
    int height = 0;    ///< what panels and title bars leave of it
    std::string font;  ///< TrueType file; empty: DejaVu Sans where Debian keeps it
    protocols::Language language = protocols::Language::en;
    protocols::InstructionTexts instructions{};  ///< in that language; empty: the words' sentence
};

/// The subject's window: a canvas with triangles and text. Anti-aliasing is the caller's: a corner
/// of cover 0 makes an edge fade out. Works on any SDL video driver, "dummy" included. Once the
/// display is lost (display.hpp) nothing may be drawn.
class Window {
public:
    /// @throws std::runtime_error if there is no display, no renderer or no font: what, and the
    /// remedy
    explicit Window(const WindowOptions& options);
    ~Window();

    [[nodiscard]] engine::Vec2 size() const;  ///< pixels
    /// Pixels of the canvas for one of the display's units, in which pointers come: > 1 where
    /// the desktop scales small pixels up.
    [[nodiscard]] double scale() const;
    /// Asks the desktop for the keyboard.
    void take_keyboard();
    [[nodiscard]] const Words& words() const noexcept { return *words_; }
    [[nodiscard]] protocols::Language language() const noexcept { return language_; }
    /// What the protocol says in place of some of the words.
    [[nodiscard]] const protocols::InstructionTexts& instructions() const noexcept {
        return instructions_;
    }
    void clear(Colour colour);
    /// Corners in threes. Both windings are drawn.
    void triangles(std::span<const Corner> corners, Colour colour);
    /// Draws shapes finer than whole pixels also where SDL's software renderer rounds their corners
    /// to them: `shapes` is drawn four times as large and scaled down. With a graphics card it is
    /// just called. Nothing but triangles() inside `corner`, `extent` may be drawn by it.
    void fine(const engine::Vec2& corner,
              const engine::Vec2& extent,
              const std::function<void()>& shapes);
    /// `at` is the left end, centre or right end of the line's middle. @param height of the type,
    /// pixels
    void text(std::string_view line,
              const engine::Vec2& at,
              double height,
              Colour colour,
              Align align = Align::centre);
    /// All lines since the last clear().
    [[nodiscard]] const std::vector<TextExtent>& written() const noexcept { return written_; }
    /// Pixels that the line would take.
    [[nodiscard]] double text_width(std::string_view line, double height);
    void present();
    /// Once a window manager has given the window its frame, which comes some time after it, keeps
    /// both inside of the monitor; only then, for people may move it.
    void mind_frame();
    /// In the window's title, behind the program's name.
    void name_screen(std::string_view name);
    void show_pointer(bool shown);
    /// Puts the pointer there, pixels of the canvas, wherever it was; what it did before is
    /// forgotten.
    void put_pointer(const engine::Vec2& pixel);

    /// What was last presented, RGBA, rows from the top.
    [[nodiscard]] std::vector<std::uint8_t> pixels() const;
    /// @throws as write_whole()
    void save_png(const std::string& file) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
    std::vector<TextExtent> written_;
    const Words* words_;
    protocols::Language language_;
    protocols::InstructionTexts instructions_;
};

// Colours and sizes of the subject's screen: light type on a dark, even grey, so that the room
// stays dim and nothing flickers from screen to screen.

inline constexpr Colour kBackground{24, 27, 33};
inline constexpr Colour kText{232, 234, 238};
inline constexpr Colour kQuiet{146, 152, 164};
inline constexpr Colour kAccent{255, 190, 92};
inline constexpr Colour kCard{244, 242, 236};
inline constexpr Colour kShape{198, 210, 222};
inline constexpr Colour kOutline{32, 44, 60};
inline constexpr Colour kWall{120, 132, 148};

/// Height of running text, pixels: on a screen of 24 inches its small letters are 5.1 mm high,
/// which is 22 minutes of arc from 80 cm. Narrow windows have smaller type, so that sentences keep
/// their rows.
[[nodiscard]] inline double type_size(const engine::Vec2& window) {
    const double by_height = window.y / 32.0;
    const double by_width = window.x / 48.0;
    return by_height < by_width ? by_height : by_width;
}

/// What the experimenter reads from 1 m, in type sizes. On a screen of 24 inches, 0.30 m high, its
/// small letters are 6.7 mm high, 23 minutes of arc; ISO 9241-303 asks for 16 at least, and for 20
/// to 22.
inline constexpr double kFromAfar = 1.3;
/// The bar of the experimenter's desk begins here, as a share of the window's height: nothing that
/// a participant has to read stands below.
inline constexpr double kBarTop = 0.89;

}  // namespace palpate::ui
