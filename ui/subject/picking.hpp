#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocols/trial/observer.hpp"
#include "ui/subject/picture_row.hpp"
#include "ui/subject/stage.hpp"

namespace palpate::ui {

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
