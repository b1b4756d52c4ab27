#include "engine/base/text.hpp"
#include "data/analysis/summary.hpp"
#include "data/inference/stats_report.hpp"
#include "data/store/people.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// Answers all that is left.
void run_on(Database& database, const data::SessionSpec& spec) {
    auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    for (const std::size_t at : opened.progress.pending().order()) {
        recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[at]),
                           answered(0, false));
    }
    recorder.finish_session();
}

struct Answered {
    std::vector<std::size_t> shapes;
    std::vector<std::size_t> responses;
};

/// `trials` of five shapes, each as often; a share of the answers is right, the others are any
/// shape, or a neighbour.
Answered some_answers(std::mt19937_64& random,
                      std::size_t trials,
                      double right,
                      bool near = false) {
    std::uniform_real_distribution<double> uniform;
    Answered all;
    for (std::size_t i = 0; i < trials; ++i) {
        const std::size_t shape = i % 5;
        const auto beside = [&] {
            return shape == 0 || (shape < 4 && random() % 2 == 0) ? shape + 1 : shape - 1;
        };
        all.shapes.push_back(shape);
        all.responses.push_back(uniform(random) < right ? shape : near ? beside() : random() % 5);
    }
    return all;
}

/// Bits of a channel that is right with probability `right` and guesses among five else.
double bits_of(double right) {
    const double hit = right + (1.0 - right) / 5.0;
    const double other = (1.0 - right) / 5.0;
    return std::log2(5.0) + hit * std::log2(hit) + 4.0 * other * std::log2(other);
}

/// Of one that is right or names a neighbour.
double bits_beside(double right) {
    const double wrong = 1.0 - right;
    // Shares of the answers: an outer shape, the next one, the middle one.
    const double outer = (right + 0.5 * wrong) / 5.0;
    const double next = (right + 1.5 * wrong) / 5.0;
    const double middle = (right + wrong) / 5.0;
    const auto term = [](double p) {
        return p * std::log2(p);
    };
    const double of_response = -2.0 * term(outer) - 2.0 * term(next) - term(middle);
    const double of_outer = -term(right) - term(wrong);
    const double of_inner = -term(right) - 2.0 * term(0.5 * wrong);
    return of_response - (2.0 * of_outer + 3.0 * of_inner) / 5.0;
}

}  // namespace

TEST_CASE("an answer that does not count is kept with its reason, left out and counted apart") {
    SmallSession session;
    Database& database = session.database;
    auto bad = answered(1, true);
    bad.invalid = "path below 160 mm";
    const auto id = session.record(0, bad);
    CHECK_THAT(data::summary_text(database), Has("1 answered trial is invalid"));
    session.record(1, answered(1, true));
    CHECK(lines(database,
                "SELECT trial_id, invalid_reason FROM analysis_trial WHERE invalid_reason IS NOT "
                "NULL") == fmt::format("{} path below 160 mm \n", id));
    CHECK(lines(database, "SELECT plan_position FROM analysis_trial WHERE counts") == "1 \n");
    CHECK(lines(database, "SELECT sum(n) FROM confusion") == "1 \n");
    CHECK(lines(database, "SELECT count(*) FROM response") == "2 \n");
    // The recorder takes no reason for what was not answered.
    protocols::TrialResult aborted;
    aborted.outcome = protocols::Outcome::aborted;
    aborted.invalid = "x";
    CHECK_THROWS_AS(session.record(2, aborted), std::logic_error);
}

TEST_CASE("an answer marked afterwards is left out, kept, and run again unless all is finished") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol());
    {
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        for (std::size_t i = 0; i < 3; ++i) {
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[i]),
                               answered(0, false));
        }
        protocols::TrialResult aborted;
        aborted.outcome = protocols::Outcome::aborted;
        recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[3]), aborted);
        CHECK_THROWS_WITH(data::mark_invalid(database, 2, {"x"}), Has("runs now"));
    }
    CHECK_THROWS_WITH(data::mark_invalid(database, 99, {"x"}), Has("no trial 99"));
    CHECK_THROWS_WITH(data::mark_invalid(database, 4, {"x"}), Has("aborted"));
    CHECK_FALSE(data::mark_invalid(database, 2, {"she sneezed"}).finished);
    CHECK_THROWS_WITH(data::mark_invalid(database, 2, {"again"}), Has("she sneezed"));
    CHECK(lines(database, "SELECT trial_id FROM analysis_trial WHERE counts ORDER BY 1") ==
          "1 \n3 \n");
    CHECK(lines(database, "SELECT trial_id, text FROM event WHERE event_kind = 'mark'") ==
          "2 she sneezed \n");
    {
        const auto opened = data::open_session(database, spec);
        CHECK(opened.progress.pending().has(1));
        CHECK_FALSE(opened.progress.pending().has(0));
        CHECK_FALSE(opened.progress.pending().has(2));
        // What was aborted stays where it was; the marked one is somewhere after where it might
        // have been next.
        std::vector<std::size_t> others = opened.progress.pending().order();
        std::erase(others, 1U);
        CHECK(others == std::vector<std::size_t>{3, 4, 5});
    }
    run_on(database, spec);
    CHECK(data::mark_invalid(database, 1, {"late"}).finished);
    CHECK(data::open_session(database, spec).finished);
}

TEST_CASE("what is noted of a participant stays until it is noted otherwise") {
    NewDatabase database;
    CHECK_FALSE(data::find_participant(database, "P1").has_value());
    data::note_participant(database, "P1", {.handedness = 80, .consent = true});
    data::note_participant(database, "P1", {.details = {{"age", "31"}, {"gender", "f"}}});
    data::note_participant(database, "P1", {.handedness = -100, .details = {{"age", "32"}}});
    const auto person = data::find_participant(database, "P1");
    REQUIRE(person.has_value());
    CHECK(person->notes.handedness == -100);
    CHECK(person->notes.consent == true);
    CHECK_FALSE(person->consent_utc.empty());
    CHECK(person->notes.details ==
          std::vector<std::pair<std::string, std::string>>{{"age", "32"}, {"gender", "f"}});
    CHECK(person->sessions == 0);
    data::note_participant(database, "P1", {.consent = false});
    CHECK(data::find_participant(database, "P1")->notes.consent == false);
    CHECK_THROWS_AS(data::note_participant(database, "P2", {.handedness = 101}), data::StoreError);
    CHECK_FALSE(data::find_participant(database, "P2").has_value());  // all or nothing
}

TEST_CASE("participant, note and mark work from the command line and refuse with a sentence") {
    const TemporaryFile file("a.sqlite");
    const Finished unknown = palpate_command({"participant", file, "P1"});
    CHECK(unknown.code != 0);
    CHECK(palpate_command({"note", file, "text", "--participant", "P1"}).code != 0);
    CHECK(palpate_command({"mark", file, "1", "--invalid", "x"}).code != 0);
    ran({"participant", file, "Jane Doe", "--consent", "yes"}, 2);
    ran({"participant", file, "P1", "--set", "Age=3"}, 2);
    CHECK_THAT(
        ran({"participant", file, "P1", "--new", "--set", "age=31", "--set", "age=32"}, 2).error,
        Has("--set age", "twice"));
    ran({"participant", file, "P1", "--handedness", "101"}, 2);
    CHECK(::access(file.c_str(), F_OK) != 0);  // nothing was made of all that

    const Finished noted = ran({"participant", file, "P1", "--new", "--handedness", "-40",
                                "--consent", "yes", "--set", "age=31", "--set", "x="});
    CHECK_THAT(noted.out, Has("handedness   -40", "consent      yes, noted 2", "age          31"));
    CHECK(palpate_command({"participant", file, "P1"}).out == noted.out);
    ran({"participant", file, "P2"}, 2);
    CHECK_THAT(ran({"participant", file, "P2", "--set", "age=32"}, 2).error,
               Has("nobody is called P2: --new registers them"));
    CHECK_THAT(ran({"participant", file, "P1", "--new", "--consent", "no"}, 2).error,
               Has("P1 is there already"));
    CHECK(palpate_command({"participant", file, "P1"}).out == noted.out);
    CHECK_THAT(palpate_command({"note", file, "text", "--participant", "P1"}).error,
               Has("P1 has no session yet"));
    {
        Database database(file, Access::write);
        for (const std::size_t number : {1U, 2U}) {
            const auto spec = session_spec(small_protocol(), "P1", number);
            const auto opened = data::open_session(database, spec);
            data::SqliteRecorder recorder(database, spec.protocol, opened.id);
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[0]),
                               answered(0, false));
        }
        auto other = small_protocol();
        other.id = "other";
        static_cast<void>(data::open_session(database, session_spec(other, "P1", 1)));
    }
    CHECK_THAT(palpate_command({"note", file, "text", "--participant", "P1"}).error,
               Has("other and in small: give --study"));
    ran({"note", file, " ", "--participant", "P1", "--study", "small"}, 2);
    CHECK_THAT(
        palpate_command({"note", file, "tired", "--participant", "P1", "--study", "small"}).out,
        Has("session 2 of P1, study small"));
    ran({"note", file, "early", "--participant", "P1", "--study", "small", "--session", "1"});
    CHECK_THAT(palpate_command({"mark", file, "1", "--invalid", "bell rang"}).out,
               Has("run again when its session is resumed"));
    ran({"mark", file, "1", "--invalid", "bell rang"}, 2);
    Database database(file, Access::read);
    CHECK(lines(database,
                "SELECT session_number, event.event_kind, text FROM event JOIN session USING "
                "(session_id) WHERE event.event_kind <> 'participant' ORDER BY event.event_id") ==
          "2 note tired \n1 note early \n1 mark bell rang \n");
    CHECK(lines(database, "SELECT count(*) FROM participant") == "1 \n");
}

TEST_CASE("UTF-8 is distinguished from what is none, byte by byte as RFC 3629 has it") {
    // Every sequence of one, two and three bytes against the ranges of the RFC's table 3-7 in
    // Unicode.
    const auto by_table = [](unsigned a, unsigned b, unsigned c) -> std::size_t {
        const auto tail = [](unsigned x) {
            return x >= 0x80 && x <= 0xBF;
        };
        if (a <= 0x7F) {
            return 1;
        }
        if (a >= 0xC2 && a <= 0xDF && tail(b)) {
            return 2;
        }
        const bool second = a == 0xE0 ? b >= 0xA0 && b <= 0xBF
                          : a == 0xED ? b >= 0x80 && b <= 0x9F
                                      : tail(b);
        return a >= 0xE0 && a <= 0xEF && second && tail(c) ? 3 : 0;
    };
    std::size_t wrong = 0;
    for (unsigned a = 0; a < 0xF0; ++a) {
        for (unsigned b = 0; b < 256; ++b) {
            for (const unsigned c : {0x00U, 0x41U, 0x7FU, 0x80U, 0xBFU, 0xC0U, 0xFFU}) {
                const char bytes[] = {static_cast<char>(a), static_cast<char>(b),
                                      static_cast<char>(c)};
                wrong += utf8_length({bytes, 3}) == by_table(a, b, c) ? 0U : 1U;
            }
        }
    }
    CHECK(wrong == 0);
    CHECK(utf8_length("\xF0\x9F\x98\x80") == 4);
    for (const char* bad : {"\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80",
                            "\xF0\x9F\x98", "\xE2\x82", "\xC3", "a\x80"}) {
        CHECK_FALSE(is_utf8(bad));
    }
    CHECK(is_utf8("çukur, 凹, \xF0\x9F\x98\x80"));
}

TEST_CASE("words that are not UTF-8 are refused before they are kept") {
    const TemporaryFile file("a.sqlite");
    ran({"demo", "--headless", "--db", file});
    Database database(file, Access::read);
    const auto noted = [&] {
        return lines(database, "SELECT count(*) FROM event") +
               lines(database, "SELECT count(*) FROM participant_detail");
    };
    const std::string before = noted();
    const std::string code = lines(database, "SELECT participant_code FROM participant");
    const std::string who = code.substr(0, code.find(' '));
    for (const Words& words : {Words{"note", file, "caf\xE9", "--participant", who},
                               {"mark", file, "1", "--invalid", "\xFF"},
                               {"participant", file, who, "--set", "name=Ren\xE9"}}) {
        CHECK_THAT(ran(words, 2).error, Has("UTF-8"));
    }
    CHECK(noted() == before);
}

TEST_CASE("bits: all of five shapes known is log2 5, and a guesser of 50 trials shows 0.28 bits",
          "[inference]") {
    std::mt19937_64 random(1);
    const Answered sure = some_answers(random, 50, 1.0);
    const Transmitted all = transmitted(sure.shapes, sure.responses, 99, 1, 1);
    CHECK(all.bits.plug_in == Approx(std::log2(5.0)).epsilon(1e-12));
    CHECK(all.null_p == 0.01);
    CHECK(all.interval.value().high == Approx(std::log2(5.0)));
    double plug_in = 0.0;
    double null_mean = 0.0;
    double corrected = 0.0;
    int found = 0;
    constexpr int kGuessers = 200;
    for (int i = 0; i < kGuessers; ++i) {
        const Answered one = some_answers(random, 50, 0.0);
        const Transmitted sent = transmitted(one.shapes, one.responses, 99, 1, 1);
        plug_in += sent.bits.plug_in / kGuessers;
        null_mean += sent.null_mean.value() / kGuessers;
        corrected += sent.bits.miller_madow / kGuessers;
        found += sent.null_p <= 0.05 ? 1 : 0;
    }
    CHECK(std::fabs(plug_in - 0.28) < 0.02);
    CHECK(std::fabs(null_mean - plug_in) < 0.02);
    CHECK(std::fabs(corrected - 0.08) < 0.02);
    CHECK(found <= 22);  // 5 % of 200, and four of its errors
    const Answered one = some_answers(random, 50, 0.5);
    CHECK(transmitted(one.shapes, one.responses, 200, 1, 7).null_mean ==
          transmitted(one.shapes, one.responses, 200, 1, 7).null_mean);
    CHECK(transmitted(one.shapes, one.responses, 200, 2, 7).null_mean !=
          transmitted(one.shapes, one.responses, 200, 1, 7).null_mean);
    CHECK_FALSE(transmitted({}, {}, 10, 1, 1).interval);
}

TEST_CASE("the permutation null is the mean over all ways to deal the answers", "[inference]") {
    const std::vector<std::size_t> shapes{0, 0, 0, 1, 1, 1};
    const std::vector<std::size_t> responses{0, 0, 0, 0, 1, 1};
    // The two answers 1 fall on 15 pairs of trials: 9 mixed, 6 on one shape.
    const auto bits = [](double a, double b, double n) {
        const double p = a / n;
        return p == 0.0 ? 0.0 : p * std::log2(p / (b / n));
    };
    const double mixed = 2.0 * (bits(2, 3.0 * 4 / 6, 6) + bits(1, 3.0 * 2 / 6, 6));
    const double split =
        bits(3, 3.0 * 4 / 6, 6) + bits(1, 3.0 * 4 / 6, 6) + bits(2, 3.0 * 2 / 6, 6);
    const Transmitted sent = transmitted(shapes, responses, 40000, 5, 2);
    CHECK(sent.bits.plug_in == Approx(split).epsilon(1e-12));
    CHECK(sent.null_mean.value() == Approx((9.0 * mixed + 6.0 * split) / 15.0).epsilon(0.02));
    CHECK(sent.null_p.value() == Approx(0.4).margin(0.01));
}

// PALPATE_BITS_PEOPLE=4000 draws so many people; what then comes is in docs/data.md.
TEST_CASE("the interval of transmitted bits holds the channel's own", "[inference]") {
    const char* asked = std::getenv("PALPATE_BITS_PEOPLE");
    const int people = asked != nullptr ? std::atoi(asked) : 300;
    const double right = GENERATE(0.3, 0.5, 0.7);
    const std::size_t trials = GENERATE(std::size_t{50}, std::size_t{100});
    const bool near = GENERATE(false, true);
    const double truth = near ? bits_beside(right) : bits_of(right);
    std::mt19937_64 random(3);
    int held = 0;
    double bias = 0.0;
    for (int i = 0; i < people; ++i) {
        const Answered one = some_answers(random, trials, right, near);
        const Transmitted sent = transmitted(one.shapes, one.responses, 0, 1, 1);
        held += sent.interval->low <= truth && truth <= sent.interval->high ? 1 : 0;
        bias += (sent.bits.miller_madow - truth) / people;
    }
    CAPTURE(right, trials, near, held, bias);
    if (asked != nullptr) {
        WARN("right " << right << (near ? ", else beside, " : ", ") << trials << " trials: held "
                      << static_cast<double>(held) / people << ", Miller-Madow's bias " << bias);
    }
    CHECK(static_cast<double>(held) / people > 0.93 - 3.5 * std::sqrt(0.05 / people));
}

TEST_CASE("the area of confidence is the share of pairs, ties half, counted one by one",
          "[inference]") {
    std::mt19937 random(GENERATE(seeds(30U)));
    const auto levels = [&] {
        std::vector<double> all(1 + random() % 20);
        for (double& one : all) {
            one = static_cast<double>(1 + random() % 4);
        }
        return all;
    };
    const auto right = levels();
    const auto wrong = levels();
    double pairs = 0.0;
    for (const double a : right) {
        for (const double b : wrong) {
            pairs += a > b ? 1.0 : a == b ? 0.5 : 0.0;
        }
    }
    CHECK(type_2_area(right, wrong).value() ==
          Approx(pairs / static_cast<double>(right.size() * wrong.size())).epsilon(1e-13));
    CHECK_FALSE(type_2_area(right, {}));
    CHECK_FALSE(type_2_area({}, wrong));
}

TEST_CASE("a trend gives back the slopes of a plane, and leaves out what it cannot tell apart",
          "[inference]") {
    const auto seed = GENERATE(seeds(20U));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto [a, b, c] = std::array{uniform(random), uniform(random), uniform(random)};
    std::vector<Moment> moments;
    for (int i = 0; i < 60; ++i) {
        const double rest = i % (10 + static_cast<int>(seed % 5));
        moments.push_back({.trial = 1.0 + i, .since_break = rest, .value = a + b * i + c * rest});
    }
    CHECK(trend(moments).trial.value() == Approx(b).margin(1e-12));
    CHECK(trend(moments).since_break.value() == Approx(c).margin(1e-11));
    moments[5].since_break = std::nullopt;
    CHECK_FALSE(trend(moments).since_break);
    for (Moment& one : moments) {  // one stretch without a break
        one.since_break = one.trial - 1.0;
        one.value = b * one.trial;
    }
    CHECK_FALSE(trend(moments).since_break);
    CHECK(trend(moments).trial.value() == Approx(b).margin(1e-12));
    moments.resize(2);
    CHECK_FALSE(trend(moments).trial);
    CHECK_FALSE(trend({}).trial);
}
