#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/geometry/vec.hpp"
#include "protocols/trial/observer.hpp"
#include "ui/subject/answer_row.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

/// From pixels of the window to the object's frame: 0.25 mm a unit of the display, y up, and the
/// middle of the window is the point (0, 30 mm), so that the whole object and the start pose fit
/// into 800 x 600 of them. A unit is a pixel, or the `scale` pixels that a desktop makes of one
/// where they are small.
struct PointerMap {
    static constexpr double kMetresPerUnit = 0.25e-3;
    static constexpr engine::Vec2 kMiddle{0.0, 0.030};

    engine::Vec2 window{};  ///< size, pixels
    double scale = 1.0;     ///< Window::scale()

    /// Pixels, y down, to the object frame, m, y up; to_pixel() is its inverse but for rounding.
    [[nodiscard]] engine::Vec2 to_object(const engine::Vec2& pixel) const {
        const engine::Vec2 d = pixel - 0.5 * window;
        return kMiddle + kMetresPerUnit / scale * engine::Vec2{d.x, -d.y};
    }
    [[nodiscard]] engine::Vec2 to_pixel(const engine::Vec2& object) const {
        const engine::Vec2 d = (object - kMiddle) * (scale / kMetresPerUnit);
        return 0.5 * window + engine::Vec2{d.x, -d.y};
    }
};

/// From presses to an answer. A digit or a click names one, the arrows mark one and Enter takes it.
/// Where answers are confirmed, digits and clicks mark too, and the marked one is the answer once
/// Enter, its digit or a click on it says so; until then another may be marked.
class Picker {
public:
    /// @param shown_ns  when the question was shown
    Picker(std::int64_t shown_ns, bool confirm) : shown_ns_(shown_ns), confirm_(confirm) {}

    /// @return whether another card is marked now
    bool handle(const Input& input, std::span<const Card> cards);
    [[nodiscard]] std::optional<std::size_t> marked() const noexcept { return marked_; }
    /// The answer with its times: reaction_s of the press that gave it, not of the one that
    /// confirmed it.
    [[nodiscard]] const std::optional<protocols::Choice>& chosen() const noexcept {
        return chosen_;
    }

private:
    bool name(std::size_t place, const Input& input, protocols::InputKind kind);
    bool mark(std::size_t place, const Input& input, protocols::InputKind kind);
    void take(const Input& input);
    [[nodiscard]] double since_shown(const Input& input) const;

    std::int64_t shown_ns_;
    bool confirm_;
    std::optional<std::size_t> marked_;
    protocols::Choice given_{};  ///< the marked one, as if it were taken
    protocols::Confirmation confirmation_{};
    std::optional<protocols::Choice> chosen_;
};

}  // namespace palpate::ui
