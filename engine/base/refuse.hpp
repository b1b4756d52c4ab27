#pragma once

#include <stdexcept>
#include <utility>

#include <fmt/core.h>

namespace palpate {

/// Refuses where something comes in: throws an Error with a sentence as fmt::format() makes it. The
/// values of the sentence are computed before it is known whether they are needed, in any order.
template <class Error = std::invalid_argument, class... Values>
void refuse_if(bool wrong, fmt::format_string<Values...> sentence, Values&&... values) {
    if (wrong) {
        throw Error(fmt::format(sentence, std::forward<Values>(values)...));
    }
}

}  // namespace palpate
