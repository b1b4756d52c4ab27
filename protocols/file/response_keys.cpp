#include <array>

#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

// clang-format off
constexpr std::array kResponse{
    Key<ResponseSpec>{.name = "kind", .member = &ResponseSpec::kind, .late = true,
                      .meaning = "what is asked after feeling"},
    Key<ResponseSpec>{.name = "question", .member = &ResponseSpec::question, .text = Text::free, .late = true,
                      .meaning = "what the screen asks; left out: a sentence of its own"},
    Key<ResponseSpec>{.name = "levels", .member = &ResponseSpec::levels, .lowest = 2, .highest = 9, .late = true,
                      .meaning = "of a rating"},
    Key<ResponseSpec>{.name = "low", .member = &ResponseSpec::low, .text = Text::free, .late = true,
                      .meaning = "label of a rating's first level, or of no"},
    Key<ResponseSpec>{.name = "high", .member = &ResponseSpec::high, .text = Text::free, .late = true,
                      .meaning = "label of a rating's last level, or of yes"},
    Key<ResponseSpec>{.name = "confidence", .member = &ResponseSpec::confidence, .late = true,
                      .meaning = "after the answer: how sure, 1 to 4"},
    Key<ResponseSpec>{.name = "confirm", .member = &ResponseSpec::confirm, .late = true,
                      .meaning = "answers can be changed until Enter, or the same one again, confirms them"},
    Key<ResponseSpec>{.name = "feedback", .member = &ResponseSpec::feedback, .late = true,
                      .meaning = "after which answers the screen says right or wrong"},
};
// clang-format on

}  // namespace

template <>
std::span<const Key<ResponseSpec>> keys_of() {
    return kResponse;
}

}  // namespace palpate::protocols
