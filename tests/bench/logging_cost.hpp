#pragma once

#include <vector>

namespace palpate::bench {

/// What keeping a tick costs the servo thread: flight recorder, ring, latest value, lateness
/// histogram.
struct LoggingCost {
    std::vector<double>
        logging_ns;  ///< the four alone, once a tick at 1 kHz: caches are as a loop finds them
    std::vector<double>
        bare_ns;  ///< a tick of the warm loop without ring, latest value and histogram
    std::vector<double> logged_ns;  ///< the same with them, in turns of 100 ticks
};

/// @param seconds  of the 1 kHz loop
[[nodiscard]] LoggingCost measure_logging(double seconds);

}  // namespace palpate::bench
