
#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "protocols/procedure/procedure.hpp"
#include "data/analysis/summary.hpp"
#include "data/inference/stats_report.hpp"
#include "data/page/sections.hpp"
#include "data/store/stored_progress.hpp"

namespace palpate::data {
namespace {

std::string list_of(const std::vector<std::string>& names) {
    std::string out;
    for (std::size_t i = 0; i < names.size(); ++i) {
        out += i == 0 ? "" : i + 1 == names.size() ? " and " : ", ";
        out += names[i];
    }
    return out;
}

std::string friction_text(const protocols::FrictionSpec& one) {
    if (one.law == "frictionless") {
        return fmt::format("\u201c{}\u201d (none)", one.name);
    }
    return one.mu_s == one.mu_d
             ? fmt::format("\u201c{}\u201d (law {}, coefficient {:g})", one.name, one.law, one.mu_d)
             : fmt::format("\u201c{}\u201d (law {}, static {:g}, dynamic {:g})", one.name, one.law,
                           one.mu_s, one.mu_d);
}

std::string objects_text(const protocols::Protocol& protocol) {
    std::vector<std::string> names;
    std::size_t unpictured = 0;
    for (const auto& one : protocol.objects) {
        unpictured += one.pictured ? 0U : 1U;
        if (one.pictured) {
            const std::string yields =
                one.compliance > 0.0
                    ? fmt::format(", which yields by {:g} mm/N", 1e3 * one.compliance)
                    : "";
            names.push_back(protocol.surface ? fmt::format("{} ({:g} and {:g} 1/m)", one.name,
                                                           one.curvature, one.cross_curvature)
                            : one.segments.empty()
                                ? fmt::format("{} ({:g} 1/m{})", one.name, one.curvature, yields)
                                : one.name + " (a free form)");
        }
    }
    return list_of(names) + (unpictured == 0 ? ""
                                             : fmt::format(", and {} that no picture shows",
                                                           counted(unpictured, "object")));
}

std::string task_text(const protocols::Protocol& protocol) {
    const protocols::ResponseSpec& asked = protocol.response;
    std::string out = "One of the pictured objects was chosen as the one that had been felt.";
    if (asked.kind == protocols::ResponseKind::two_interval) {
        out = "Two objects were felt one after the other, and one of them was named.";
    } else if (asked.kind == protocols::ResponseKind::yes_no) {
        out = "A question was answered with yes or no.";
    } else if (asked.kind == protocols::ResponseKind::rating) {
        out = fmt::format("What was felt was rated on {} levels.", asked.levels);
    }
    if (!asked.question.empty()) {
        out += fmt::format(" The question was \u201c{}\u201d.", asked.question);
    }
    if (asked.confidence) {
        out += " After each answer confidence was given on four levels, from a guess to sure.";
    }
    return out;
}

std::string design_text(const protocols::Protocol& protocol) {
    if (protocol.procedure) {
        const std::string stimulus = stimulus_text(protocol);
        return fmt::format(
            "{}, {}{}.",
            constant_stimuli(protocol)
                ? fmt::format("Every level ({}) was felt equally often, in an order drawn for each "
                              "run, whatever was answered",
                              stimulus)
                : fmt::format("A rule chose what was felt ({}) by the answers so far", stimulus),
            counted(protocol.procedure->trials, "trial"),
            protocol.runs.size() > 1
                ? fmt::format(" of each of {} interleaved runs", protocol.runs.size())
                : "");
    }
    const auto& design = protocol.design;
    return fmt::format(
        "Each object was felt with each friction {} times in the main trials, in an order drawn "
        "for each session{}{}.",
        design.repetitions,
        design.max_run_object > 0
            ? fmt::format(", with no object more than {} times in a row", design.max_run_object)
            : std::string(),
        design.break_every > 0 ? fmt::format(", with a break every {} trials", design.break_every)
                               : std::string());
}

std::string of_held(std::string_view query) {
    return fmt::format("{}\n{}", page_query("held"), page_query(query));
}

/// The protocol's limit of force, and each other one that held.
std::string limit_text(const Study& study) {
    const Rows limits = study.ask(of_held("limits"));
    std::string text = fmt::format("{:g} N", study.protocol.apparatus.force_limit);
    for (std::size_t row = 0; row < limits.cells.size(); ++row) {
        const std::string& other = limits.text(row, "force_limit");
        if (!other.empty()) {
            text += fmt::format(" (in {} of the attempts, practice included: {})",
                                limits.text(row, "attempts"), other);
        }
    }
    return text;
}

/// Through what objects were explored, and what became of the force.
std::string device_text(const Study& study) {
    bool handle = false;
    bool pointer = false;
    for (const std::string& device :
         study.ask("SELECT DISTINCT device FROM main").levels("device")) {
        (TrialDevice{device, {}}.gives_force() ? handle : pointer) = true;
    }
    constexpr const char* kPointer = "with the pointer of a mouse, which gives no force";
    if (pointer && !handle) {
        return fmt::format("{}; the contact force was computed", kPointer);
    }
    return fmt::format(
        "through a handle with {} degrees of freedom{}{}; the contact force was rendered",
        study.protocol.surface ? "three" : "two", pointer ? ", and in some trials " : "",
        pointer ? kPointer : "");
}

/// What d' is, where there is one.
std::string sensitivity_text(const StatsReport& stats) {
    return stats.yes_no ? stats.right_known ? " d' and criterion c are those of yes and no, with "
                                              "the log-linear correction (Hautus 1995)."
                                            : ""
         : stats.table.alternatives < 2
             ? ""
             : fmt::format(
                   " d' is that of an unbiased observer of {} alternatives (Green & "
                   "Swets 1966).",
                   stats.table.alternatives);
}

/// How people were tested, with what was drawn by chance.
void add_tests(PageWriter& page, const Study& study, const StatsReport& stats) {
    const StatsOptions& options = stats.options;
    page.paragraph(fmt::format(
        "The primary test, as the protocol says, is the {}. The unit of all tests is the "
        "person; nothing pools the trials of several people. The effect of friction is the "
        "difference within person, with Student's paired t and its 95 % "
        "interval, the exact sign-flip test (Fisher 1935), Wilcoxon's signed ranks (1945, exact, "
        "ties kept) and the JZS Bayes factor (Rouder et al. 2009, Cauchy prior of scale {:.4f}). "
        "Means of shares have intervals by Student's t on the logit of the mean. A logistic mixed "
        "model with random intercepts and slopes follows, by Laplace's approximation and by "
        "adaptive Gauss-Hermite quadrature ({} nodes a side); the p of its likelihood ratio is "
        "also that of {} samples of the fitted null.{} Transmitted information is Miller and "
        "Madow's, against {} permutations.{} Random numbers begin with seed {}.",
        primary_title(stats), options.prior_scale, options.nodes, options.simulations,
        sensitivity_text(stats), options.permutations,
        study.protocol.response.confidence
            ? " Confidence is judged by the area under the type 2 ROC (Galvin et al. 2003)."
            : "",
        options.seed));
}

/// The commands whose tests are on the page.
std::string commands_text(const Study& study, const PageNumbers& numbers) {
    std::vector<std::string> all;
    const auto add = [&](bool there, const std::string& words) {
        if (there) {
            all.push_back(fmt::format("<code>{}</code>", html_text(words)));
        }
    };
    add(numbers.stats.has_value(), numbers.stats_words);
    add(numbers.fit.has_value(), numbers.fit_words);
    add(study.protocol.response.kind == protocols::ResponseKind::rating, summary_words(study));
    add(numbers.audit.has_value(), numbers.audit_words);
    return all.empty() ? std::string() : ", the tests with " + list_of(all);
}

}  // namespace

bool constant_stimuli(const protocols::Protocol& protocol) {
    return protocol.procedure &&
           std::holds_alternative<protocols::ConstantStimuliSpec>(*protocol.procedure->rule.spec);
}

void add_provenance(PageWriter& page, const Study& study) {
    page.section("seals", "Seals and provenance");
    const Rows seals = study.ask(page_query("seals"));
    std::size_t good = 0;
    for (std::size_t row = 0; row < seals.cells.size(); ++row) {
        good +=
            seals.number(row, "without_seal") == 0.0 && seals.number(row, "newest_is_stored") == 1.0
                ? 1U
                : 0U;
    }
    page.paragraph(
        fmt::format("Each attempt, event and end of a session carries a seal: a hash over all that "
                    "came before. In {} of {} the newest seal is stored beside the row that made "
                    "it, and nothing that ended is without one. This is a look, no proof: palpate "
                    "verify {} computes every seal, plan and force again. A seal in the lab book "
                    "that is the same shows that nothing before it was changed.",
                    good, counted(seals.cells.size(), "session"), study.file));
    page.table("sessions", "Newest seals", "One row a session.", seals);
    page.table("made", "Made with",
               "Versions and hashes of the sessions' programs and calibrations. What tells a "
               "machine is in the file alone.",
               study.ask(of_held("made")));
}

void add_methods(PageWriter& page, const Study& study, const PageNumbers& numbers) {
    page.section("methods", "Methods");
    const protocols::Protocol& protocol = study.protocol;
    const auto& apparatus = protocol.apparatus;
    std::vector<std::string> frictions;
    for (const auto& one : protocol.frictions) {
        frictions.push_back(friction_text(one));
    }
    page.paragraph(fmt::format(
        "{} explored unseen objects {} at {:g} kHz on the exact {} with a "
        "stiffness of {:g} N/m and limited to {}. Objects were {}; friction was {}. {} {}",
        study.options.kind == "simulated" ? "Simulated hands" : "Participants", device_text(study),
        apparatus.rate_hz / 1000.0, protocol.surface ? "surfaces" : "curves", apparatus.stiffness,
        limit_text(study), objects_text(protocol), list_of(frictions), task_text(protocol),
        design_text(protocol)));
    page.paragraph(
        fmt::format("Attempts in which the force went off, or which fell short of the protocol's "
                    "rules for a trial, were run again later in the session. People were left out "
                    "by rules in the protocol, written before anybody ran; {}. {} had a session.",
                    numbers.stats ? "each test of friction is given with and without these "
                                    "exclusions"
                                  : "results are of the others",
                    counted(study.left_out.in_file.people, "person", "people")));
    if (numbers.stats) {
        add_tests(page, study, *numbers.stats);
    }
    if (numbers.fit && !numbers.fit->curves.empty()) {
        page.paragraph(fmt::format(
            "Psychometric functions were fitted by maximum likelihood from a grid of starts, and "
            "again by a second optimiser; intervals are those of the profile likelihood and of {} "
            "parametric bootstrap samples (bias-corrected percentiles).",
            numbers.fit->options.bootstrap));
    }
    if (numbers.audit) {
        page.paragraph(
            fmt::format("Conditions of friction were compared in start pose, lateness, saturation, "
                        "stale readings, gaps of the masking noise, times, strokes, force and "
                        "speed by two one-sided tests of 5 % (Schuirmann 1987), with bounds of "
                        "{:g} mm, a ratio of {:g} and a share of {:g}.",
                        1e3 * numbers.bounds.place_m, numbers.bounds.ratio, numbers.bounds.share));
    }
    page.html(
        fmt::format("<p>All numbers can be had again from the file: each figure's SQL with "
                    "<code>palpate sql {}{} --csv</code>{}.</p>\n",
                    html_text(study.file), study.seen, commands_text(study, numbers)));
}

}  // namespace palpate::data
