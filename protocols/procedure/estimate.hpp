#pragma once

#include <optional>
#include <string>

namespace palpate::protocols {

/// What a procedure says of one quantity so far.
struct Estimate {
    std::string name;            ///< threshold, slope, ...; the staircase's name
    std::optional<double> mean;  ///< of the posterior, or of a staircase's last reversals
    std::optional<double> mode;  ///< of the posterior

    friend bool operator==(const Estimate&, const Estimate&) = default;
};

}  // namespace palpate::protocols
