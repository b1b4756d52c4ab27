#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace palpate::data {

/// How often each stimulus was answered with each response.
using ConfusionCounts = std::map<std::pair<std::string, std::string>, std::int64_t>;

/// Transmitted information H(stimulus) + H(response) - H(both), bits.
struct Information {
    double plug_in = 0.0;  ///< from the shares as they are: too high for few answers
    /// Each entropy corrected by (cells that occur - 1) / (2 N ln 2) (G. A. Miller, 1955). May be
    /// below 0.
    double miller_madow = 0.0;
};

/// {0, 0} without any answer. @pre no count is negative
[[nodiscard]] Information mutual_information(const ConfusionCounts& counts);

}  // namespace palpate::data
