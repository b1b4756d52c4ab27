#pragma once

#include <string>

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"

/// Small studies with a rule.
namespace palpate::tests {

inline constexpr const char* kQuestPlusRule = R"(kind = "quest_plus"
trials = 7
nuisance = ["lapse"]
[procedure.model]
family = "normal"
lapse_form = "two_sided"
slope_as = "sd"
[procedure.stimuli]
stimulus = { from = -3, to = 13, step = 2 }
[procedure.parameters]
threshold = { from = 1, to = 9, step = 1 }
sd = [1, 2, 4, 8]
lapse = [0, 0.05]
)";

inline constexpr const char* kStaircaseRule = R"(kind = "staircase"
[[procedure.staircase]]
start = 12
down = 2
step_up = [4, 2]
lowest = 5.5
highest = 15
trials = 4
[[procedure.staircase]]
start = 9
down = 1
step_up = 1
lowest = 5.5
highest = 15
trials = 3
)";

/// Two runs of seven trials and two practice trials, each interval felt for 0.3 s.
inline std::string adaptive_text(const std::string& rule,
                                 const std::string& kind = "two_interval") {
    const bool two = kind == "two_interval";
    return R"(format = 1
[study]
id = "adaptive"
title = "A small study with a rule"
seed = 5
[apparatus]
start_mm = [0, 45]
[[object]]
name = "reference"
curvature_per_m = 5
[[friction]]
name = "off"
law = "frictionless"
[[friction]]
name = "on"
law = "gos"
mu_s = 0.7
mu_d = 0.5
[response]
kind = ")" +
           kind +
           R"("
question = "Which was more convex?"
confidence = true
[procedure]
varies = "curvature_per_m"
object = "reference"
practice_trials = 2
practice_stimulus = 13
)" + rule +
           R"([[run]]
name = "equal"
friction = "off"
[[run]]
name = "different"
friction = "on"
)" + (two ? "standard_friction = \"off\"\n" : "") +
           R"([invalid]
contact_min_s = 0
path_min_mm = 0
[design]
break_every = 5
[timing]
explore_min_s = 0.1
explore_prompt_s = 0.2
explore_timeout_s = 0.3
gap_s = 0
)";
}

inline protocols::Protocol adaptive_protocol(const std::string& rule = kQuestPlusRule,
                                             const std::string& kind = "two_interval") {
    return protocols::parse_protocol(adaptive_text(rule, kind), "p.toml");
}

}  // namespace palpate::tests
