#include "data/statistics/information.hpp"

#include <cmath>
#include <numbers>

namespace palpate::data {
namespace {

struct Entropy {
    double bits = 0.0;
    double cells = 0.0;  ///< that occur
};

template <class Counts>
Entropy entropy(const Counts& counts, double all) {
    Entropy entropy;
    for (const auto& [key, n] : counts) {
        if (n > 0) {
            const double share = static_cast<double>(n) / all;
            entropy.bits -= share * std::log2(share);
            entropy.cells += 1.0;
        }
    }
    return entropy;
}

}  // namespace

Information mutual_information(const ConfusionCounts& counts) {
    std::map<std::string, std::int64_t> stimuli;
    std::map<std::string, std::int64_t> responses;
    std::int64_t sum = 0;
    for (const auto& [pair, n] : counts) {
        stimuli[pair.first] += n;
        responses[pair.second] += n;
        sum += n;
    }
    if (sum == 0) {
        return {};
    }
    const auto all = static_cast<double>(sum);
    const Entropy x = entropy(stimuli, all);
    const Entropy y = entropy(responses, all);
    const Entropy both = entropy(counts, all);
    const double plug_in = x.bits + y.bits - both.bits;
    const double cells = x.cells + y.cells - both.cells - 1.0;
    return {.plug_in = plug_in, .miller_madow = plug_in + cells / (2.0 * all * std::numbers::ln2)};
}

}  // namespace palpate::data
