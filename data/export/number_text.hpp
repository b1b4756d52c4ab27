#pragma once

#include <string>

namespace palpate::data {

/// A number in the fewest digits from which C, Python and R all read back the same bits; 18 digits
/// where R would miss the fewest that C needs: it reads in extended precision and rounds twice
/// (arithmetic.c, R_strtod), which is wrong for about one number in 4,000. inf and -inf are written
/// so, NaN as "nan".
[[nodiscard]] std::string number_text(double value);

}  // namespace palpate::data
