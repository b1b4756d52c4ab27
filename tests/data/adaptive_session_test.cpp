#include <nlohmann/json.hpp>

#include "protocols/design/adaptive_plan.hpp"
#include "protocols/file/procedure_file.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/analysis/summary.hpp"
#include "data/store/people.hpp"
#include "data/store/stored_progress.hpp"
#include "data/sync/merge.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/process.hpp"
#include "tests/support/studies.hpp"

using namespace palpate;
using namespace palpate::data;
using namespace palpate::tests;
using protocols::TrialId;

namespace {

/// Dies in the call that it is asked to.
class Killer : public protocols::Recorder {
public:
    struct Killed {};

    Killer(protocols::Recorder& recorder, int at) : recorder_(recorder), left_(at) {}

    TrialId begin_trial(const protocols::PlannedTrial& planned) override {
        step();
        return recorder_.begin_trial(planned);
    }
    void begin_interval(TrialId trial,
                        const protocols::Presentation& felt,
                        const protocols::SceneConstants& scene) override {
        step();
        recorder_.begin_interval(trial, felt, scene);
    }
    void append(TrialId trial, std::span<const engine::TickRecord> ticks) override {
        recorder_.append(trial, ticks);
    }
    void end_trial(TrialId trial, const protocols::TrialResult& result) override {
        step();
        recorder_.end_trial(trial, result);
        step();
    }
    void event(const protocols::Event& event) override { recorder_.event(event); }
    void finish_session() override { recorder_.finish_session(); }

private:
    void step() {
        if (--left_ == 0) {
            throw Killed{};
        }
    }

    protocols::Recorder& recorder_;
    int left_;
};

/// Everything that was felt and answered in trials that count, as text.
std::string content(Database& database) {
    std::string text;
    for (const char* sql :
         {"SELECT plan_position, interval, stimulus, presentation.felt_object, "
          "presentation.curvature_per_m, friction, mu_s, mu_d, presentation.slip_decay, "
          "presentation.ticks, presentation.path_length_m, presentation.mean_normal_force_n FROM "
          "presentation JOIN trial USING (trial_id) JOIN response USING (trial_id) WHERE "
          "invalid_reason IS NULL ORDER BY plan_position, interval",
          "SELECT plan_position, response.* FROM response JOIN trial USING (trial_id) WHERE "
          "invalid_reason IS NULL ORDER BY plan_position",
          "SELECT plan_position, run_trial_number, run_name, stimulus, rule_outcome, correct, "
          "estimate, estimates, state_sha256 FROM analysis_trial WHERE run_trial_number IS NOT "
          "NULL AND counts ORDER BY plan_position"}) {
        for (const data::Statement& row : database.prepare(sql)) {
            for (int column = 0; column < row.columns(); ++column) {
                if (row.name(column) != "trial_id") {
                    text += row.null(column)      ? "-"
                          : row.type(column) == 2 ? fmt::format("{} ", row.real(column))
                                                  : row.text(column) + ' ';
                }
            }
            text += '\n';
        }
    }
    return text;
}

}  // namespace

TEST_CASE(
    "a session with a rule that was killed anywhere and resumed gives what the unbroken one gives",
    "[long][adaptive][law]") {
    const std::string rule = GENERATE(kQuestPlusRule, kStaircaseRule);
    const TemporaryFolder folder;
    const data::SessionSpec spec = session_spec(adaptive_protocol(rule));
    Database whole(folder.file("whole.sqlite"), Access::write);
    REQUIRE(run_simulated(whole, spec).why == protocols::SessionEnd::Why::finished);
    const std::string unbroken = content(whole);
    REQUIRE(count(whole, "analysis_trial WHERE run_trial_number IS NOT NULL") == 14);
    REQUIRE(count(whole, "presentation") == 32);
    CHECK(differences(whole).empty());

    int kills = 0;
    for (int at = 1;; at += 5, ++kills) {
        Database broken(folder.file(fmt::format("{}.sqlite", at)), Access::write);
        const auto dying = [at](protocols::Recorder& recorder) {
            return Killer(recorder, at);
        };
        bool killed = false;
        try {
            static_cast<void>(run_simulated(broken, spec, dying));
        } catch (const Killer::Killed&) {
            killed = true;
        }
        if (!killed) {
            break;
        }
        CAPTURE(at);
        REQUIRE(run_simulated(broken, spec).why == protocols::SessionEnd::Why::finished);
        REQUIRE(content(broken) == unbroken);
        REQUIRE(differences(broken).empty());
    }
    CHECK(kills > 12);
}

TEST_CASE("a changed stimulus, outcome or state of a rule lets nothing run", "[adaptive][law]") {
    const TemporaryFolder folder;
    const data::SessionSpec spec = session_spec(adaptive_protocol());
    const char* edit = GENERATE(
        "UPDATE presentation SET stimulus = stimulus + 2 WHERE trial_id = 6 AND stimulus IS NOT "
        "NULL",
        "UPDATE adaptive_step SET rule_outcome = 1 - rule_outcome WHERE trial_id = 5",
        "UPDATE adaptive_step SET state_sha256 = replace(state_sha256, substr(state_sha256, 9, 1), "
        "'x') WHERE trial_id = 4",
        "UPDATE adaptive_plan SET run_number = 1 - run_number WHERE plan_position = 4",
        "DELETE FROM adaptive_step WHERE trial_id = 5");
    Database database(folder.file("a.sqlite"), Access::write);
    const auto dying = [](protocols::Recorder& recorder) {
        return Killer(recorder, 50);
    };
    REQUIRE_THROWS_AS(run_simulated(database, spec, dying), Killer::Killed);
    REQUIRE(count(database, "adaptive_step") > 6);
    const std::int64_t trials = count(database, "trial");
    CAPTURE(edit);
    database.execute(edit);
    CHECK_FALSE(differences(database).empty());
    CHECK_THROWS_WITH(run_simulated(database, spec), Has("nothing was run"));
    CHECK(count(database, "trial") == trials);
}

TEST_CASE("a trial that does not count leaves the rule as it was, and its stimulus comes again",
          "[adaptive][law]") {
    const TemporaryFolder folder;
    protocols::Protocol protocol = adaptive_protocol();
    protocol.invalid.path_min = 0.025;  // some hands are slower than that
    const data::SessionSpec spec = session_spec(protocol);
    Database database(folder.file("a.sqlite"), Access::write);
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    const std::int64_t invalid = count(database,
                                       "trial JOIN plan USING (session_id, plan_position) WHERE "
                                       "phase = 'main' AND invalid_reason IS NOT NULL");
    CAPTURE(invalid);
    CHECK(invalid > 3);
    CHECK(count(database,
                "adaptive_step JOIN trial USING (trial_id) WHERE invalid_reason IS NOT NULL") == 0);
    CHECK(differences(database).empty());
}

TEST_CASE("an answer marked after a break is forgotten by the rule, and verify knows",
          "[adaptive][law]") {
    const TemporaryFolder folder;
    const data::SessionSpec spec = session_spec(adaptive_protocol());
    Database database(folder.file("a.sqlite"), Access::write);
    const auto dying = [](protocols::Recorder& recorder) {
        return Killer(recorder, 40);
    };
    REQUIRE_THROWS_AS(run_simulated(database, spec, dying), Killer::Killed);
    CHECK_FALSE(data::mark_invalid(database, 5, {"the phone rang"}).finished);
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    CHECK(count(database, "analysis_trial WHERE run_trial_number IS NOT NULL AND counts") == 14);
    CHECK(count(database, "analysis_trial WHERE run_trial_number IS NOT NULL AND NOT counts") == 1);
    CHECK(differences(database) == "");
}

TEST_CASE("a run handed to palpate procedure gives the stored estimates and states",
          "[adaptive][law]") {
    const std::string rule = GENERATE(kQuestPlusRule, kStaircaseRule);
    const TemporaryFolder folder;
    const data::SessionSpec spec = session_spec(adaptive_protocol(rule));
    Database database(folder.file("a.sqlite"), Access::write);
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    for (std::int64_t run = 0; run < 2; ++run) {
        const data::ExportedRun made = data::exported_run(database, 1, run);
        protocols::ProcedureFile file = protocols::parse_procedure(made.procedure, "run.toml");
        protocols::Procedure& procedure = file.procedure;
        // Whose run it is cannot be read from it.
        CHECK_THAT(
            made.procedure,
            Has(stream_origin(run_key(session_stream(spec), static_cast<std::size_t>(run)))) &&
                !Has("P01") && !Has(kSecret) && !Has(spec.protocol_hash));
        data::Statement row = database.prepare(
            "SELECT stimulus, rule_outcome, state_sha256, estimates FROM analysis_trial WHERE "
            "run_trial_number IS NOT NULL AND run_number = ?1 ORDER BY run_trial_number",
            run);
        std::string responses = "stimulus,response\n";
        for (int n = 0; row.step(); ++n) {
            CAPTURE(run, n);
            REQUIRE(procedure.next().front() == row.real(0));
            const double shown = row.real(0);
            procedure.update(std::span(&shown, 1), static_cast<std::size_t>(row.integer(1)));
            REQUIRE(procedure.state_hash() == row.text(2));
            REQUIRE(data::estimates_text(procedure.estimates()) == row.text(3));
            responses += fmt::format("{},{}\n", row.real(0), row.integer(1));
        }
        CHECK(procedure.finished());
        CHECK(made.responses == responses);
    }
}

TEST_CASE("verify reports every edit of what a rule chose and what intervals let one feel",
          "[adaptive][law]") {
    const TemporaryFolder folder;
    const data::SessionSpec spec = session_spec(adaptive_protocol());
    Database database(folder.file("a.sqlite"), Access::write);
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    REQUIRE(differences(database).empty());
    for (const std::string table : {"presentation", "adaptive_step", "adaptive_plan"}) {
        for (const std::string& column : result_columns(database, {table})) {
            CAPTURE(column);
            const std::string name = column.substr(column.find('.') + 1);
            // A key that is taken, or what a CHECK refuses, is no edit.
            const std::string sql = fmt::format(
                "UPDATE {0} SET {1} = CASE typeof({1}) WHEN 'integer' THEN {1} + 1 WHEN 'real' "
                "THEN {1} + 0.25 WHEN 'text' THEN 'f' || substr({1}, 2) || 'x' ELSE 1 END WHERE "
                "rowid = 9",
                table, name);
            const Undone undone(database);
            try {
                database.execute(sql.c_str());
            } catch (const data::StoreError&) {
                continue;
            }
            CHECK_FALSE(differences(database).empty());
        }
    }
}

TEST_CASE("a part that is begun again keeps its answers apart, and the rest goes as planned",
          "[adaptive][resume][law]") {
    const bool adaptive = GENERATE(true, false);
    const auto how = GENERATE(data::Resume::redo_block, data::Resume::redo_practice);
    const int at = GENERATE(3, 25, 44);
    CAPTURE(adaptive, static_cast<int>(how), at);
    const TemporaryFolder folder;
    protocols::Protocol protocol = adaptive_protocol();
    if (!adaptive) {
        protocol.procedure.reset();
        protocol.runs.clear();
        protocol.response = {};
        protocol.objects = small_protocol().objects;
        protocol.design = {.repetitions = 2, .catch_trials = 0, .blocks = 2};
    }
    data::SessionSpec spec = session_spec(protocol);
    spec.kind = data::RunKind::simulated;
    // As of a present palpate: verify computes the answers again, each from its trial's number.
    spec.provenance = {{"build id", "test"}};
    for (const auto& [key, hash] : protocols::object_hashes(protocol)) {
        spec.provenance.emplace_back(key, hash);
    }
    Database database(folder.file("a.sqlite"), Access::write);
    const auto dying = [at](protocols::Recorder& recorder) {
        return Killer(recorder, at);
    };
    REQUIRE_THROWS_AS(run_simulated(database, spec, dying), Killer::Killed);
    const std::int64_t answered = count(database, "response");
    spec.resume = how;
    const auto last = [&] {
        return data::open_session(database, spec).progress.pending().order();
    }();
    CHECK(std::is_sorted(last.begin(), last.end()));
    const std::int64_t marked = count(database, "trial WHERE invalid_reason IS NOT NULL");
    CHECK((marked > 0) == (count(database, "event WHERE event_kind = 'redo'") == 1));
    CHECK(marked == count(database, "event WHERE event_kind = 'mark'"));
    CHECK(count(database, "response") == answered);
    spec.resume = data::Resume::go_on;
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    CHECK(count(database,
                "(SELECT DISTINCT plan_position FROM trial JOIN response USING (trial_id) WHERE "
                "invalid_reason IS NULL)") == static_cast<std::int64_t>(spec.plan.trials.size()));
    CHECK(count(database, "trial JOIN response USING (trial_id) WHERE invalid_reason IS NULL") ==
          static_cast<std::int64_t>(spec.plan.trials.size()));
    CHECK(differences(database) == "");
    if (at == 25) {  // in a file where its trials have other numbers
        Database other(folder.file("b.sqlite"), Access::write);
        REQUIRE_THROWS_AS(run_simulated(other, session_spec(protocol, "P2"), dying),
                          Killer::Killed);
        const std::string all = folder.file("all.sqlite");
        REQUIRE(data::merge_files(all, {folder.file("b.sqlite")}).conflicts.empty());
        REQUIRE(data::merge_files(all, {folder.file("a.sqlite")}).conflicts.empty());
        Database merged(all, Access::read);
        CHECK(count(merged, "session") == 2);
        CHECK(differences(merged) == "");
    }
}

TEST_CASE("the summary counts answers without pictures, and says what each run of a rule estimates",
          "[adaptive][analysis]") {
    const bool staircase = GENERATE(false, true);
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = session_spec(adaptive_protocol(staircase ? kStaircaseRule : kQuestPlusRule));
    REQUIRE(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    const std::string text = data::summary_text(database);
    CAPTURE(text);
    CHECK(text.find("felt") == std::string::npos);
    CHECK(text.find("share correct") == std::string::npos);
    const auto summary = [&] {
        return nlohmann::json::parse(data::summary_json(database)).at("studies").at(0);
    };
    for (const auto& run : summary().at("runs")) {
        CHECK(run.at("answers") == 7);
        CHECK(run.at("planned") == 7);
        CHECK(run.at("marked") == 0);
    }
    CHECK(summary().at("runs").size() == 2);
    // The first estimate of the second run.
    const auto said = [&] {
        const auto all = summary().at("estimates");
        const auto& one = *std::ranges::find(all, "different", [](const auto& row) {
            return row.at("run").template get<std::string>();
        });
        CHECK(one.at("estimate") == (staircase ? "staircase_1" : "threshold"));
        return one.at("mean").is_null()
                 ? "unknown"
                 : fmt::format("{:.4g}", one.at("mean").template get<double>());
    };
    const auto estimate = [&](int n) {
        data::Statement row = database.prepare(
            "SELECT iif(estimate IS NULL, 'unknown', printf('%.4g', estimate)), trial_id FROM "
            "analysis_trial WHERE run_trial_number IS NOT NULL AND run_number = 1 AND "
            "run_trial_number = ?1");
        REQUIRE(row.bind(1, std::int64_t{n}).step());
        return std::pair(row.text(0), row.integer(1));
    };
    CHECK(said() == estimate(7).first);
    data::mark_invalid(database, estimate(7).second, {"bell"});
    // Without the last answer the rule stands where it stood after the sixth.
    CHECK(said() == estimate(6).first);
    CHECK(summary().at("runs").at(1).at("marked") == 1);
}
