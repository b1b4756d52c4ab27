#pragma once

namespace palpate::protocols {

/// Three of a sample's values: so large that a tenth, a half, nine tenths of all are no larger. 0
/// of none.
struct Deciles {
    double p10 = 0.0;
    double p50 = 0.0;
    double p90 = 0.0;
};

}  // namespace palpate::protocols
