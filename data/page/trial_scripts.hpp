#pragma once

#include <string_view>

/// What stands in the page of a trial beside its numbers, as it lies in third_party/uplot and trial_script.js.
namespace palpate::data {

[[nodiscard]] std::string_view uplot_script();   ///< defines uPlot
[[nodiscard]] std::string_view uplot_style();    ///< its style sheet
[[nodiscard]] std::string_view uplot_licence();  ///< MIT: goes with every copy
[[nodiscard]] std::string_view trial_script();   ///< draws the page's ticks with it

}  // namespace palpate::data
