#include <array>

#include "protocols/file/keys.hpp"

namespace palpate::protocols {
namespace {

constexpr double kMostStimulus = 1e10;

// clang-format off
constexpr std::array kAdaptive{
    Key<AdaptiveSpec>{.name = "varies", .member = &AdaptiveSpec::varies, .need = Need::required,
                      .meaning = "what the rule chooses: the curvature, or mu_s (mu_d keeps its share)"},
    Key<AdaptiveSpec>{.name = "stimulus_as", .member = &AdaptiveSpec::stimulus_as, .late = true,
                      .meaning = "log10: what is felt is 10 to the power of what the rule chooses"},
    Key<AdaptiveSpec>{.name = "object", .member = &AdaptiveSpec::object, .need = Need::required,
                      .meaning = "name of the object that is felt; as it stands it is the standard"},
    Key<AdaptiveSpec>{.name = "practice_trials", .member = &AdaptiveSpec::practice_trials, .highest = 100, .late = true,
                      .meaning = "before the others, in turn of all runs"},
    Key<AdaptiveSpec>{.name = "practice_stimulus", .member = &AdaptiveSpec::practice_stimulus, .lowest = -kMostStimulus, .highest = kMostStimulus, .late = true,
                      .meaning = "of the comparison in all practice trials"},
    Key<AdaptiveSpec>{.name = "practice_balanced", .member = &AdaptiveSpec::practice_balanced, .late = true,
                      .meaning = "true: of every run's practice one half has the comparison in each interval; false: drawn"},
    Key<AdaptiveSpec>{.name = "max_run", .member = &AdaptiveSpec::max_run, .highest = 1000, .late = true,
                      .meaning = "trials of the same run in a row; 0: no limit"},
    Key<AdaptiveSpec>{.name = "max_run_interval", .member = &AdaptiveSpec::max_run_interval, .highest = 1000, .late = true,
                      .meaning = "comparisons in the same interval in a row; 0: no limit"},
};

constexpr std::array kRun{
    Key<RunSpec>{.name = "name", .member = &RunSpec::name, .need = Need::required,
                 .meaning = "names the run in the database"},
    Key<RunSpec>{.name = "friction", .member = &RunSpec::friction, .need = Need::required,
                 .meaning = "name of the comparison's friction"},
    Key<RunSpec>{.name = "standard_friction", .member = &RunSpec::standard_friction, .late = true,
                 .meaning = "name of the standard's friction; left out: the same"},
};
// clang-format on

}  // namespace

template <>
std::span<const Key<AdaptiveSpec>> keys_of() {
    return kAdaptive;
}
template <>
std::span<const Key<RunSpec>> keys_of() {
    return kRun;
}

}  // namespace palpate::protocols
