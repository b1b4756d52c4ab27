# Writes OUTPUT, a C++ file that holds what the page of a trial needs as texts: uPlot with its style and licence from
# the folder UPLOT, and the page's own SCRIPT.
file(READ "${UPLOT}/uPlot.iife.min.js" uplot)
file(READ "${UPLOT}/uPlot.min.css" style)
file(READ "${UPLOT}/LICENSE" licence)
file(READ "${SCRIPT}" script)
file(WRITE "${OUTPUT}" "#include \"data/page/trial_trace.hpp\"

namespace palpate::data {

std::string_view uplot_script() { return R\"palpate_page(${uplot})palpate_page\"; }

std::string_view uplot_style() { return R\"palpate_page(${style})palpate_page\"; }

std::string_view uplot_licence() { return R\"palpate_page(${licence})palpate_page\"; }

std::string_view trial_script() { return R\"palpate_page(${script})palpate_page\"; }

}  // namespace palpate::data
")
