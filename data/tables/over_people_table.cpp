#include "data/tables/over_people_table.hpp"

#include <cmath>

#include <fmt/format.h>

namespace palpate::data {

Table over_people_table(std::string place, std::span<const OverPeople> all) {
    constexpr auto kSignificant = Column::Says::significant;
    Table table{
        .place = std::move(place),
        .title = "  Over people (mean, of ratios the geometric one, Student's interval of 95 %)",
        .columns = {{.key = "what", .words = "what"},
                    {.key = "people", .words = "people"},
                    {.key = "mean", .words = "mean", .says = kSignificant},
                    {.key = "interval_95", .words = "interval", .says = kSignificant},
                    {.key = "sign_flip_p", .words = "sign-flip p", .says = Column::Says::p},
                    {.key = "median", .words = "median, unbounded by rank", .says = kSignificant},
                    {.key = "geometric", .on_page = false},
                    {.key = "left_out", .on_page = false}}};
    for (const OverPeople& one : all) {
        const auto shown = [&](double value) {
            return one.ratio ? std::exp(value) : value;
        };
        std::optional<Interval> ends = one.mean.interval;
        if (ends) {
            ends = Interval{shown(ends->low), shown(ends->high)};
        }
        std::vector<std::string> left_out;
        for (const LeftOutPerson& person : one.left_out) {
            left_out.push_back(fmt::format("{} ({})", person.name, person.why));
        }
        if (!left_out.empty()) {
            table.notes.push_back(fmt::format("{}: {}", one.what, without_text(one.left_out)));
        }
        table.rows.push_back({one.what, cell_of(one.mean.people), cell_of(shown(one.mean.mean)),
                              cell_of(ends), one.test ? Cell(one.test->p) : Cell(Nothing{}),
                              one.median ? cell_of(shown(*one.median)) : Cell(Nothing{}), one.ratio,
                              std::move(left_out)});
    }
    return table;
}

}  // namespace palpate::data
