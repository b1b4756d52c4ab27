#include "data/analysis/left_out.hpp"
#include "data/analysis/summary.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

namespace {

protocols::Protocol study() {
    protocols::Protocol protocol = small_protocol(4);
    protocol.objects.push_back({.name = "low", .curvature = -20.0, .pictured = false});
    protocol.objects.push_back({.name = "high", .curvature = 20.0, .pictured = false});
    protocol.design.catch_trials = 4;
    protocol.design.max_run_object = 0;  // any order: counting those within limits takes longest
    protocol.design.max_run_friction = 0;
    protocol.exclusion = {.catch_correct_min = 0.75,
                          .share_correct_min = 0.5,
                          .timed_out_share_max = 0.25,
                          .invalid_share_max = 0.2,
                          .sessions_finished = true};
    return protocol;
}

/// How a made-up participant answers: the share of each, in order of the trials.
struct Habits {
    double correct = 1.0, timed_out = 0.0, invalid = 0.0, catches = 1.0;
    bool finishes = true;
};

/// True for `share` of the counts 0, 1, 2, ...: of 24, exactly 24 * share rounded.
bool due(std::size_t count, double share) {
    return static_cast<int>(static_cast<double>(count + 1) * share + 1e-9) >
           static_cast<int>(static_cast<double>(count) * share + 1e-9);
}

void run(data::Database& database,
         const protocols::Protocol& protocol,
         const std::string& code,
         const Habits& habits,
         data::RunKind kind = data::RunKind::real) {
    auto spec = session_spec(protocol, code);
    spec.kind = kind;
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    std::size_t main = 0;
    std::size_t catches = 0;
    for (const auto& planned : spec.plan.trials) {
        const std::size_t felt = planned.condition.object;
        if (planned.phase == protocols::Phase::catch_trial) {
            const std::size_t right = felt == 3 ? 0 : 2;  // concave is place 0, convex 2
            const std::size_t said = due(catches++, habits.catches) ? right : 1;
            recorder.end_trial(begin_trial(recorder, spec.protocol, planned),
                               answered(said, false));
            continue;
        }
        const bool right = due(main, habits.correct);
        auto result = answered(right ? felt : (felt + 1) % 3, right);
        if (due(main, habits.timed_out)) {
            result.outcome = protocols::Outcome::timed_out;
        }
        if (due(main, habits.invalid)) {
            result.invalid = "short_contact";
        }
        recorder.end_trial(begin_trial(recorder, spec.protocol, planned), result);
        ++main;
    }
    if (habits.finishes) {
        database.run("UPDATE session SET finished = 1 WHERE session_id = ?1", opened.id);
    }
}

Words rules_of(const data::LeftOut& account, const std::string& code) {
    Words rules;
    for (const auto& [person, rule] : account.broken) {
        if (person == code) {
            rules.push_back(rule.substr(0, rule.find(':')));
        }
    }
    return rules;
}

data::LeftOut judged(data::Database& database,
                     const char* study = "small",
                     const char* kind = "real") {
    return data::left_out_of(database, study, kind, true);
}

}  // namespace

TEST_CASE(
    "each rule of exclusion leaves out who breaks it and nobody else, on either side of its "
    "bound") {
    NewDatabase database;
    const protocols::Protocol protocol = study();
    using List = std::vector<std::string>;
    run(database, protocol, "GOOD", {});
    run(database, protocol, "EDGE", {.correct = 0.5, .timed_out = 0.25, .catches = 0.75});
    run(database, protocol, "CATCH", {.catches = 0.5});
    run(database, protocol, "WRONG", {.correct = 11.0 / 24.0});
    run(database, protocol, "SLOW", {.timed_out = 7.0 / 24.0});
    run(database, protocol, "SHORT", {.invalid = 5.0 / 24.0});
    run(database, protocol, "GONE", {.finishes = false});
    run(database, protocol, "BOTH", {.correct = 0.25, .catches = 0.0});
    run(database, protocol, "SIM", {.correct = 0.0}, data::RunKind::simulated);
    const data::LeftOut real = judged(database);
    CHECK(real.rules);
    CHECK(real.in_file.people == 8);
    CHECK(rules_of(real, "GOOD").empty());
    CHECK(rules_of(real, "EDGE").empty());
    CHECK(rules_of(real, "CATCH") == List{"catch_correct_min"});
    CHECK(rules_of(real, "WRONG") == List{"share_correct_min"});
    CHECK(rules_of(real, "SLOW") == List{"timed_out_share_max"});
    CHECK(rules_of(real, "SHORT") == List{"invalid_share_max"});
    CHECK(rules_of(real, "GONE") == List{"sessions_finished"});
    CHECK(rules_of(real, "BOTH") == List{"catch_correct_min", "share_correct_min"});
    CHECK(rules_of(judged(database, "small", "simulated"), "SIM") == List{"share_correct_min"});
    CHECK(judged(database, "other").in_file.people == 0);
}

TEST_CASE("answers that are neither right nor wrong are in no share of right ones") {
    NewDatabase database;
    const protocols::Protocol protocol = study();
    run(database, protocol, "HALF", {.correct = 11.0 / 24.0});
    CHECK(rules_of(judged(database), "HALF").size() == 1);
    const std::string wrong =
        "(SELECT trial_id FROM analysis_trial WHERE phase = 'main' AND correct = 0 LIMIT ";
    database.run("UPDATE response SET correct = NULL WHERE trial_id IN " + wrong + "2)");
    CHECK(rules_of(judged(database), "HALF").empty());  // 11 of 22
    database.run("UPDATE response SET correct = NULL");
    CHECK(rules_of(judged(database), "HALF").empty());
}

TEST_CASE("without rules of exclusion the summary says nothing of them") {
    NewDatabase database;
    protocols::Protocol protocol = study();
    protocol.exclusion = {};
    run(database, protocol, "P1", {.correct = 0.0, .finishes = false});
    CHECK_FALSE(judged(database).rules);
    CHECK(data::summary_text(database).find("exclusion") == std::string::npos);
}
