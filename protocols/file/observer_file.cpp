#include "protocols/file/observer_file.hpp"

#include <array>

#include <fmt/format.h>

#include "protocols/file/document.hpp"

namespace palpate::protocols {
namespace {

constexpr std::int64_t kObserverFormat = 1;

// clang-format off
constexpr Key kFrictionEffect[]{
    {.name = "noise_factor_per_mu", .slot = at<&FrictionEffectSpec::noise_per_mu>, .range = {0.01, 100},
     .meaning = "factor of the noise at a felt friction of 1; at 0.5 its root. Above 1: friction costs sensitivity"},
};

constexpr Key kPeople[]{
    {.name = "noise_sd_ln", .slot = at<&PeopleSpec::noise>, .range = {0, 3},
     .meaning = "standard deviation over people of the natural logarithm of noise_per_m"},
    {.name = "bias_sd_per_m", .slot = at<&PeopleSpec::bias>, .range = {0, 1000},
     .meaning = "of a curvature that a person adds to every percept"},
    {.name = "lapse_sd_logit", .slot = at<&PeopleSpec::lapse>, .range = {0, 5},
     .meaning = "of the logit of lapse"},
    {.name = "force_weight_sd", .slot = at<&PeopleSpec::force_weight>, .range = {0, 1},
     .meaning = "of force_weight, which is cut to 0 to 1"},
    {.name = "bias_per_mu_sd_per_m", .slot = at<&PeopleSpec::bias_per_mu>, .range = {0, 1000},
     .meaning = "of bias_per_m_per_mu: people whom friction misleads differently"},
    {.name = "noise_factor_per_mu_sd_ln", .slot = at<&PeopleSpec::noise_per_mu>, .range = {0, 3},
     .meaning = "of the logarithm of noise_factor_per_mu: people whom friction costs differently"},
    {.name = "reaction_sd_ln", .slot = at<&PeopleSpec::reaction>, .range = {0, 3},
     .meaning = "of the logarithm of median_s"},
    {.name = "speed_sd_ln", .slot = at<&PeopleSpec::speed>, .range = {0, 1},
     .meaning = "of the logarithm of speed_factor, which stays within its range"},
    {.name = "press_sd_ln", .slot = at<&PeopleSpec::press>, .range = {0, 1},
     .meaning = "of the logarithm of press_factor, which stays within its range"},
};

constexpr Key kLearning[]{
    {.name = "first_noise_factor", .slot = at<&LearningSpec::first>, .range = {0.1, 10},
     .meaning = "of the noise in the first trial of a session; 1: nothing is learned"},
    {.name = "trials", .slot = at<&LearningSpec::trials>, .range = {0, 10000, true},
     .meaning = "after so many 1/e of the difference is left; practice counts"},
};

constexpr Key kReaction[]{
    {.name = "median_s", .slot = at<&ReactionSpec::median>, .range = {0.05, 60},
     .meaning = "median of the reaction time where the answer is clear; none is below 0.25 s, or guard_s"},
    {.name = "sd_ln", .slot = at<&ReactionSpec::spread>, .range = {0, 3},
     .meaning = "standard deviation of its logarithm from trial to trial: lognormal"},
    {.name = "doubt_factor", .slot = at<&ReactionSpec::doubt>, .range = {1, 100},
     .meaning = "times as long where the percept lies between two answers, and for a guess"},
};

constexpr Key kHand[]{
    {.name = "speed_factor", .slot = at<&HandSpec::speed>, .range = {0.25, 3},
     .meaning = "of the hand's speed, 65 to 95 mm/s drawn for each trial"},
    {.name = "press_factor", .slot = at<&HandSpec::press>, .range = {0.6, 2},
     .meaning = "of how deep it means to press, 8.5 to 10 mm inside of the chords drawn for each trial; at 1000 N/m "
                "1 gives some 2 N"},
};
// clang-format on

/// A table of the file, and what it fills.
struct Part {
    std::string_view name;
    std::string_view remark;
    Keys keys;
    void* record;
};

std::array<Part, 6> parts_of(ObserverModel& model) {
    return {{{"observer", "the middle one of them", keys_of<ObserverSpec>(), &model.typical},
             {"friction", "what friction does beside its force", kFrictionEffect, &model.friction},
             {"people", "how much they differ", kPeople, &model.people},
             {"learning", "within a session", kLearning, &model.learning},
             {"reaction", "how fast they answer", kReaction, &model.reaction},
             {"hand", "how they feel", kHand, &model.hand}}};
}

/// @param explained  with what tables and keys mean
std::string tables_text(ObserverModel model, bool explained) {
    std::string text = fmt::format("format = {}\n", kObserverFormat);
    for (const Part& part : parts_of(model)) {
        text += fmt::format("\n[{}]", part.name);
        text += explained ? fmt::format("  # {}\n", part.remark) : "\n";
        for (const Key& key : part.keys) {
            text += explained ? fmt::format("# {} ({})\n", key.meaning, range_of(key.range)) : "";
            text += toml_lines({&key, 1}, part.record);
        }
    }
    return text;
}

}  // namespace

ObserverModel parse_observer(std::string_view text, std::string_view file_name) {
    const Table file = parse_document(text, file_name);
    Problems problems;
    Places places;
    ObserverModel model;
    TableReader top(file, "", {}, problems, places, "the file");
    top.check_format(kObserverFormat);
    for (const Part& part : parts_of(model)) {
        if (auto table = top.table(part.name)) {
            table->read_last(part.keys, part.record);
        }
    }
    top.refuse_unknown();
    problems.throw_if_any(file_name);
    return model;
}

ObserverModel load_observer(const std::filesystem::path& file) {
    if (std::error_code unknown; file == "typical" && !std::filesystem::exists(file, unknown)) {
        return typical_observer();
    }
    return parse_observer(read_text(file, kMaxDocument), file.string());
}

std::string observer_text(const ObserverModel& model) {
    return tables_text(model, false);
}

ObserverModel typical_observer() {
    return {.typical = {},
            .friction = {},
            .people = {.noise = 0.35,
                       .bias = 0.8,
                       .lapse = 0.5,
                       .force_weight = 0.1,
                       .bias_per_mu = 1.0,
                       .noise_per_mu = 0.15,
                       .reaction = 0.25,
                       .speed = 0.15,
                       .press = 0.08},
            .learning = {.first = 1.3, .trials = 20.0},
            .reaction = {},
            .hand = {}};
}

std::string observer_example() {
    return "# Simulated participants, for palpate simulate and palpate power. What is left out is "
           "as a "
           "person without that.\n" +
           tables_text(typical_observer(), true);
}

std::vector<TableText> observer_reference() {
    ObserverModel begun;
    std::vector<TableText> all;
    for (const Part& part : parts_of(begun)) {
        all.push_back({fmt::format("[{}]", part.name), std::string(part.remark), part.keys});
    }
    return all;
}

}  // namespace palpate::protocols
