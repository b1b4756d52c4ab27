#pragma once

#include <cstddef>
#include <string>

#include "protocols/procedure/procedure.hpp"

namespace palpate::protocols {

/// What is known of a rule before it starts.
struct RuleFacts {
    std::size_t trials = 0;  ///< it ends after so many, whatever is answered
    double lowest = 0.0;     ///< it never chooses less
    double highest = 0.0;    ///< nor more
    std::size_t outcomes = 2;

    friend bool operator==(const RuleFacts&, const RuleFacts&) = default;
};

/// @throws std::invalid_argument with the remedy if its number of trials depends on the answers, or if it
///         chooses more than one number
[[nodiscard]] RuleFacts facts_of(const ProcedureSpec& spec);

}  // namespace palpate::protocols
