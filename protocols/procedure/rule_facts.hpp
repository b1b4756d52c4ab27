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
    std::string lowest_key{};   ///< which key says `lowest`, as in "staircase.2.lowest"
    std::string highest_key{};  ///< and `highest`
    /// An outcome of 1 is more likely than not wherever it stays: what is chosen is the greater
    /// one.
    bool one_sided = false;

    friend bool operator==(const RuleFacts&, const RuleFacts&) = default;
};

/// @throws std::invalid_argument with the remedy if its number of trials depends on the answers, or
///         if it chooses more than one number
[[nodiscard]] RuleFacts facts_of(const ProcedureSpec& spec);

}  // namespace palpate::protocols
