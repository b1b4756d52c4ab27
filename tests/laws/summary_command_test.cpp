#include "data/store/sqlite_recorder.hpp"
#include "tests/support/adaptive.hpp"
#include "tests/support/json_of.hpp"
#include "tests/support/sql_first.hpp"

namespace {

/// What `script` prints of the rows of `query`, in R without any package; line by line.
Words by_r(const std::string& file, const std::string& query, const std::string& script) {
    const TemporaryFolder folder;
    const Words r{"Rscript",
                  write(folder.file("script.R"), "d <- read.csv(commandArgs(TRUE)[1])\n" + script),
                  write(folder.file("rows.csv"), sql_csv(file, query))};
    return lines_in(ended(Process(r).wait()).out);
}

std::string summary_of(const std::string& file) {
    return ran({"summary", file}).out;
}

/// Made-up people of a factorial study, each with a share of their own; the first is cut short.
void answer(const std::string& file, const protocols::Protocol& protocol, int people) {
    data::Database database(file, data::Access::write);
    database.execute("PRAGMA synchronous = OFF");
    Random random(11);
    for (int person = 0; person < people; ++person) {
        auto spec = session_spec(protocol, fmt::format("P{:02}", person + 1));
        spec.kind = data::RunKind::real;
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        const double share = random.in(0.3, 0.9);
        std::size_t n = 0;
        for (const auto& planned : spec.plan.trials) {
            const bool right =
                random.in(0.0, 1.0) < share - (planned.condition.friction == 1 ? 0.1 : 0.0);
            const std::size_t felt = planned.condition.object;
            auto result = answered(right ? felt : (felt + 1) % 3, right);
            if (protocol.response.kind != protocols::ResponseKind::identification) {
                result.response->object = 0;
                result.response->correct = std::nullopt;
                result.response->place = right ? 1 : 0;
            }
            recorder.end_trial(begin_trial(recorder, spec.protocol, planned), result);
            if (person == 0 && ++n == 20 && people > 1) {
                break;
            }
        }
    }
}

const std::string kPeopleInR = test_text("scripts/people.R");

/// mean, sd and quantiles of a posterior on a grid, after the name that the summary gives them.
const std::string kRulesInR = test_text("scripts/rules.R");

/// A kind of rule, and what it is asked: tests/texts has the rule, and it in R.
using RuleCase = std::pair<const char*, const char*>;
constexpr RuleCase kRules[] = {{"quest_plus", "two_interval"},
                               {"psi", "yes_no"},
                               {"quest", "two_interval"},
                               {"staircase", "two_interval"}};

/// A line of R's: a name, then the numbers of the summary's row of that name.
void same_numbers(const std::string& line, const Json& rows, const std::string& run) {
    std::istringstream said(line);
    std::string name;
    said >> name;
    const auto row = std::ranges::find_if(
        rows, [&](const Json& one) { return one.at("run") == run && one.at("estimate") == name; });
    REQUIRE(row != rows.end());
    std::vector<Json> ours{row->at("mean"), row->at("sd")};
    if (row->at("interval_95").is_null()) {
        ours.push_back(row->at("reversals"));
    } else {
        ours.insert(ours.end(), row->at("interval_95").begin(), row->at("interval_95").end());
    }
    for (const Json& one : ours) {
        double by_r = NAN;
        said >> by_r;
        CHECK(one.get<double>() == Approx(by_r).epsilon(1e-9));
    }
}

}  // namespace

TEST_CASE("palpate summary says of people what R says of the same answers") {
    if (!has_r()) {
        return;
    }
    const TemporaryFile file("people.sqlite");
    answer(file, small_protocol(9), 12);
    const std::string text = summary_of(file);
    CAPTURE(text);
    const auto lines =
        by_r(file,
             "SELECT participant_code AS person, friction, sum(correct) AS k, count(*) AS n FROM "
             "analysis_trial WHERE counts AND phase = 'main' GROUP BY 1, 2",
             kPeopleInR);
    REQUIRE(lines.size() == 27);
    for (const std::string& line : lines) {
        CHECK_THAT(text, Has(line));
    }
    // The SQL functions say the same interval.
    const std::string ours =
        sql_csv(file,
                "SELECT printf('%.3f  %.3f to %.3f      %d', avg(share), "
                "people_share_low(share), people_share_high(share), count(*)) FROM "
                "(SELECT friction, avg(correct) AS share FROM analysis_trial WHERE counts "
                "AND phase = 'main' GROUP BY participant_code, 1) GROUP BY friction");
    CHECK_THAT(ours, Has(lines[24], lines[25]));
}

TEST_CASE("with one person or two, palpate summary says what can be said and what cannot") {
    const TemporaryFolder folder;
    answer(folder.file("one.sqlite"), small_protocol(4), 1);
    CHECK_THAT(summary_of(folder.file("one.sqlite")),
               Has("one person: how people differ is not known",
                   "of this person's own trials (Newcombe), not of people"));
    answer(folder.file("two.sqlite"), small_protocol(8), 2);
    CHECK_THAT(summary_of(folder.file("two.sqlite")),
               Has("within person", "sign-flip: all 4 patterns of signs",
                   "2 people are too few to show a difference: no sign-flip p is "
                   "below 0.5"));
}

TEST_CASE("answers that are neither right nor wrong are summed up object by object") {
    const bool rating = GENERATE(false, true);
    const TemporaryFile file("a.sqlite");
    protocols::Protocol protocol = small_protocol(4);
    protocol.response.kind =
        rating ? protocols::ResponseKind::rating : protocols::ResponseKind::yes_no;
    protocol.response.question = "Was it convex?";
    answer(file, protocol, 3);
    const std::string text = summary_of(file);
    CAPTURE(text);
    const std::string mean = sql_row(
        file,
        "SELECT printf('friction off  %.3f  ', avg(x)) FROM (SELECT avg(answer_code + " +
            std::string(rating ? "1" : "0") +
            ") AS x FROM analysis_trial WHERE counts AND analysis_trial.planned_object = 'convex' "
            "AND friction = 'off' GROUP BY participant_code)");
    const std::size_t at = text.find(rating ? "mean level of convex, 1 the lowest, mean"
                                            : "share of yes to convex, mean");
    REQUIRE(at != std::string::npos);
    CHECK_THAT(text.substr(at), Has(mean));
    CHECK_THAT(text, Has("68 of 68 answers have no correct (NULL)"));
    CHECK_THAT(text, !Has("share correct"));
}

TEST_CASE("palpate summary says of an adaptive run what R computes from its answers") {
    if (!has_r()) {
        return;
    }
    const auto index = GENERATE(range(0, 4));
    const auto& [rule, kind] = kRules[index];
    CAPTURE(rule);
    const TemporaryFolder folder;
    write(folder.file("p.toml"),
          adaptive_text(test_text(fmt::format("procedures/rule_{}.toml", rule)), kind));
    const std::string file = run_by({"P1"}, folder.file("p.toml"), folder.file("a.sqlite"));
    // A mark made later: its answer is left out here and there.
    const std::string trial =
        sql_first(file,
                  "SELECT trial_id FROM analysis_trial WHERE run_trial_number IS NOT NULL AND "
                  "run_number = 1 AND run_trial_number = 3");
    if (index != 3) {  // a staircase goes on elsewhere without it
        ran({"mark", file, trial, "--invalid", "bell"});
    }
    const Json all = json_of({"summary", file}).at("studies").at(0);
    CAPTURE(all.dump(1));
    for (int number = 0; number < 2; ++number) {
        const auto lines =
            by_r(file,
                 fmt::format("SELECT stimulus, rule_outcome AS outcome FROM analysis_trial WHERE "
                             "run_trial_number "
                             "IS NOT NULL AND run_number = {} AND counts ORDER BY run_trial_number",
                             number),
                 kRulesInR + test_text(fmt::format("scripts/rule_{}.R", rule)));
        const std::string name = number == 0 ? "equal" : "different";
        CHECK(all.at("runs").at(static_cast<std::size_t>(number)).at("marked") ==
              (number == 1 && index != 3 ? 1 : 0));
        for (const std::string& line : lines) {
            same_numbers(line, all.at("estimates"), name);
        }
    }
    const std::string text = summary_of(file);
    CAPTURE(text);
    CHECK_THAT(text, !Has("share correct"));
}
