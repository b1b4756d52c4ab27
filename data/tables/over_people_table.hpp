#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/statistics/over_people.hpp"
#include "data/tables/table.hpp"

namespace palpate::data {

/// A number a person, over people: of those in whom it has an end.
struct OverPeople {
    std::string what{};
    PeopleMean mean{};               ///< of nobody: NaN; of a logarithm where `ratio` says so
    bool ratio = false;              ///< said as a geometric mean
    std::optional<double> median{};  ///< of everybody, what is unbounded by its rank
    std::optional<SignFlip> test{};  ///< of a difference or the logarithm of a ratio
    std::vector<LeftOutPerson> left_out{};
};

/// A row a number; who is left out stands below.
[[nodiscard]] Table over_people_table(std::string place, std::span<const OverPeople> all);

}  // namespace palpate::data
