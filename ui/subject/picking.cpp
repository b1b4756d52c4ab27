#include "ui/subject/picking.hpp"

#include <algorithm>

namespace palpate::ui {

using protocols::InputKind;

bool Picker::handle(const Input& input, std::span<const Card> cards) {
    const std::size_t last = cards.size() - 1;
    switch (input.kind) {
        case Input::Kind::digit:
            return input.digit <= static_cast<int>(cards.size()) &&
                   name(static_cast<std::size_t>(input.digit - 1), input, InputKind::key);
        case Input::Kind::click: {
            const auto place = card_at(cards, input.pixel);
            return place && name(*place, input, InputKind::mouse);
        }
        case Input::Kind::enter:
            if (marked_) {
                take(input);
            }
            return false;
        case Input::Kind::left:
            return mark(marked_ ? std::max<std::size_t>(*marked_, 1) - 1 : last, input,
                        InputKind::arrows);
        case Input::Kind::right:
            return mark(marked_ ? std::min(*marked_ + 1, last) : 0, input, InputKind::arrows);
        default:
            return false;
    }
}

bool Picker::name(std::size_t place, const Input& input, InputKind kind) {
    if (confirm_ && marked_ != place) {
        return mark(place, input, kind);
    }
    if (!confirm_) {
        marked_.reset();  // whatever the arrows have marked, this press gives the answer
        mark(place, input, kind);
    }
    take(input);
    return false;
}

bool Picker::mark(std::size_t place, const Input& input, InputKind kind) {
    if (marked_ == place) {
        return false;
    }
    if (!marked_) {
        confirmation_.first_choice_s = since_shown(input);
    } else {
        ++confirmation_.changes;
    }
    marked_ = place;
    given_ = {.place = place,
              .reaction_s = since_shown(input),
              .uncertainty_s = input.uncertainty_s,
              .input = kind};
    return true;
}

void Picker::take(const Input& input) {
    chosen_ = given_;
    if (confirm_) {
        confirmation_.confirmed_s = since_shown(input);
        chosen_->confirmation = confirmation_;
    } else if (input.kind ==
               Input::Kind::enter) {  // without more, the arrows alone say nothing yet
        chosen_->reaction_s = since_shown(input);
        chosen_->uncertainty_s = input.uncertainty_s;
    }
}

double Picker::since_shown(const Input& input) const {
    return static_cast<double>(input.seen_ns - shown_ns_) * 1e-9;
}

}  // namespace palpate::ui
