#pragma once

#include <string>
#include <vector>

#include "data/inference/trials.hpp"

namespace palpate::data {

/// A trial before its names have places.
struct NamedTrial {
    std::string subject;
    std::string shape;
    std::string friction;
    std::string response;
    Trial trial{};
};

/// The table, every list of names sorted; without source.
[[nodiscard]] TrialTable table_of_names(std::vector<NamedTrial> all);

}  // namespace palpate::data
