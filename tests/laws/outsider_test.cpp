#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "data/store/secret.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

// What somebody outside the lab makes of an export: protocol, seed, the list of all codes and this
// program's own code are known, the file is not.

namespace fs = std::filesystem;

namespace {

constexpr const char* kStudy = "shape_friction_demo";
const Words kCodes{"P01", "P02", "P03", "P04", "P05", "P06", "P07"};
const std::string kDeclined = "P03";

Finished run_as(const std::string& code, const std::string& file, Words more = {}) {
    const Words words = command_of(joined(run_words(kStudy, code, file, {"--headless"}), more));
    return Process(words, {"DISPLAY"}).wait();  // palpate_command() would give a secret
}

/// People who ran, one after the other, as if each hand had been a person's.
void record(const std::string& file, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
        REQUIRE(run_as(kCodes[i], file).code == 0);
        sql_edit(file, "UPDATE session SET session_kind = 'real'");
    }
}

std::string exported(const std::string& file,
                     const std::string& format,
                     const std::string& out,
                     Words more = {}) {
    ran(joined({"export", file, "--format", format, "-o", out}, more));
    return out;
}

using Order = Words;  ///< object and friction of every trial

/// By subject, from the exported plans.
std::map<std::string, Order> orders_in(const fs::path& folder) {
    std::map<std::string, Order> orders;
    for (const auto& line : csv_records(slurp(folder / "plan.csv"))) {
        orders[line.at("subject")].push_back(line.at("planned_object") + ' ' + line.at("friction"));
    }
    return orders;
}

/// By code, what the shipped program draws for it.
std::map<std::string, std::set<Order>> computed(const std::string& secret) {
    const protocols::Protocol protocol =
        protocols::parse_protocol(protocols::shipped_protocol(kStudy).text, kStudy);
    std::map<std::string, std::set<Order>> orders;
    for (const std::string& code : kCodes) {
        for (const std::size_t session : {1U, 2U}) {
            const protocols::Plan plan = make_plan(protocol, protocols::protocol_hash(protocol),
                                                   {code, session, secret}, protocol.seed);
            Order order;
            for (const auto& trial : plan.trials) {
                order.push_back(protocol.objects.at(trial.condition.object).name + ' ' +
                                protocol.frictions.at(trial.condition.friction).name);
            }
            orders[code].insert(order);
        }
    }
    return orders;
}

/// Subject -> code, wherever one order is that of one code.
std::map<std::string, std::string> identified(const fs::path& folder, const std::string& secret) {
    std::map<std::string, std::string> found;
    const auto by_code = computed(secret);
    for (const auto& [subject, order] : orders_in(folder)) {
        for (const auto& [code, orders] : by_code) {
            if (orders.contains(order)) {
                found[subject] = code;
            }
        }
    }
    return found;
}

std::map<std::string, std::string> codes_in(const fs::path& file) {
    std::map<std::string, std::string> codes;
    for (const auto& line : csv_records(slurp(file))) {
        codes[line.at("participant_code")] = line.at("subject");
    }
    return codes;
}

Words values(const std::string& file, const std::string& sql) {
    Words all = lines_in(sql_lines(file, sql));
    std::erase(all, "");
    return all;
}

/// What no export without details may hold: names, clocks, hashes, secrets.
Words telling(const std::string& file) {
    return values(
        file,
        "SELECT hex FROM secret UNION SELECT participant_code FROM participant UNION SELECT uuid "
        "FROM session UNION SELECT plan_sha256 FROM session UNION SELECT substr(plan_sha256, 1, 4) "
        "|| '-' || substr(plan_sha256, 5, 4) FROM session UNION SELECT seal FROM trial UNION "
        "SELECT seal FROM session UNION SELECT substr(started_utc, 1, 10) FROM session UNION "
        "SELECT CAST(started_ns AS TEXT) FROM trial UNION SELECT CAST(at_ns AS TEXT) FROM event "
        "UNION SELECT '2026-' UNION SELECT 'edinburgh'");
}

}  // namespace

TEST_CASE(
    "an outsider finds nobody in an export, nor who declined, and with the secret everybody") {
    const TemporaryFolder folder;
    const std::string file = folder.file("study.sqlite");
    record(file, 0, 4);
    ran({"participant", file, kDeclined, "--consent", "no"});
    ran({"participant", file, "P01", "--handedness", "80"});
    ran({"participant", file, "P02", "--handedness", "-30"});
    const std::string early = exported(file, "csv", folder.file("early"), {"--keep-codes"});
    record(file, 4, kCodes.size());

    const std::string plain = exported(file, "csv", folder.file("plain"));
    const auto orders = orders_in(plain);
    REQUIRE(orders.size() == kCodes.size() - 1);
    for (const std::string& guess :
         {std::string(), std::string(data::kDemoSecret), std::string(32, '0')}) {
        CHECK(identified(plain, guess).empty());
    }
    const std::string secret = values(file, "SELECT hex FROM secret").at(0);
    const auto all = identified(plain, secret);  // so that finding nobody means something
    CHECK(all.size() == kCodes.size() - 1);
    for (const auto& [subject, code] : all) {
        CHECK(code != kDeclined);
    }

    // The number of a person is theirs in every export, early and late and in every format.
    const auto late =
        codes_in(exported(file, "csv", folder.file("late"), {"--keep-codes"}) + "/codes.csv");
    for (const auto& [code, subject] : codes_in(early + "/codes.csv")) {
        CHECK(late.at(code) == subject);
    }
    for (const auto& [subject, code] : all) {
        CHECK(late.at(code) == subject);
    }
    CHECK(late.size() == kCodes.size() - 1);
    Words joined;
    for (const std::string& code : kCodes) {
        if (code != kDeclined) {
            joined.push_back(late.at(code));
        }
    }
    CHECK_FALSE(std::is_sorted(joined.begin(), joined.end()));  // by chance 1 in 720

    for (const std::string& format : Words{"csv", "bids", "psych-ds"}) {
        const std::string out =
            format == "csv" ? plain : exported(file, format, folder.file(format));
        const std::string text = everything(out);
        CAPTURE(format);
        for (const std::string& word : telling(file)) {
            CAPTURE(word);
            CHECK_THAT(text, !Has(word));
        }
        for (const auto& [code, subject] : late) {
            CHECK_THAT(text, Has(subject.substr(4)));
        }
        const std::string with = everything(exported(file, format, folder.file(format + "-details"),
                                                     {"--with-details", "--keep-codes"}));
        CHECK_THAT(with, !Has(secret));
        CHECK_THAT(with, Has("P01"));
    }
    CHECK_THAT(palpate_command({"participant", file, "P04"}).out, Has(late.at("P04")));
    std::map<std::string, std::string> hands;
    for (const auto& line : csv_records(slurp(plain + "/participants.csv"))) {
        CHECK_FALSE(line.contains("handedness_score"));
        hands[line.at("subject")] = line.at("handedness");
    }
    CHECK(hands.at(late.at("P01")) == "right");
    CHECK(hands.at(late.at("P02")) == "both");
    CHECK(hands.at(late.at("P04")).empty());
}

TEST_CASE("what an export says of time tells no date, no pause and no restart") {
    const TemporaryFolder folder;
    const std::string file = folder.file("study.sqlite");
    record(file, 0, 1);
    // Goes on two days later; then the rig was switched on anew. A hand of P02's is replayed.
    sql_edit(file,
             "UPDATE trial SET started_ns = 500000000000000 + 30000000000 * trial_id + "
             "172800000000000 * (trial_id > 3) - 672800000000000 * (trial_id > 6);UPDATE event SET "
             "at_ns = 88 + (SELECT max(started_ns) FROM trial);UPDATE session SET device = 'replay "
             "of P02_2026.sqlite'; UPDATE session SET session_number = 4");
    const std::string out = exported(file, "csv", folder.file("out"));
    Words since;
    for (const auto& line : csv_records(slurp(out + "/trials.csv"))) {
        since.push_back(line.at("since_first_ns"));
        CHECK(line.at("session_number") ==
              "1");  // not the fourth: the ones before were of another kind
    }
    CHECK(since == Words{"0", "30000000000", "60000000000", "0", "30000000000", "60000000000", "0",
                         "30000000000", "60000000000", "90000000000"});
    CHECK_THAT(everything(out), HasNone("P02", "sqlite"));
}

TEST_CASE(
    "a given secret repeats a simulated session to the bit, and enters no file that has another") {
    const TemporaryFolder folder;
    const std::string secret = "0123456789abcdef0123456789abcdef";
    const auto content = [&](const std::string& name, Words more) {
        REQUIRE(run_as("P01", folder.file(name), std::move(more)).code == 0);
        data::Database database(folder.file(name), data::Access::read);
        return content_hash(database);
    };
    const std::string first = content("a.sqlite", {"--secret", secret});
    CHECK(content("b.sqlite", {"--secret", secret}) == first);
    CHECK(content("c.sqlite", {}) != first);
    CHECK(content("d.sqlite", {"--secret", std::string(32, '1')}) != first);
    CHECK(run_as("P02", folder.file("a.sqlite"), {"--secret", secret}).code == 0);  // the same
    const std::string before = slurp(folder.file("c.sqlite"));
    check_end(run_as("P02", folder.file("c.sqlite"), {"--secret", secret}), 2,
              Has("a secret of its own"));
    CHECK(slurp(folder.file("c.sqlite")) == before);
    for (const std::string& wrong : {std::string("12"), std::string(32, 'g')}) {
        CHECK(run_as("P01", folder.file("none.sqlite"), {"--secret", wrong}).code == 2);
    }
    CHECK_FALSE(fs::exists(folder.file("none.sqlite")));
    // The demo's is known to all: people in the same file get the file's own.
    ran({"demo", "--headless", "--db", folder.file("demo.sqlite")});
    REQUIRE(run_as("P01", folder.file("demo.sqlite")).code == 0);
    const auto secrets =
        values(folder.file("demo.sqlite"), "SELECT secret FROM session ORDER BY session_id");
    CHECK(secrets.at(0) == data::kDemoSecret);
    CHECK(secrets.at(1) != data::kDemoSecret);
}

TEST_CASE("merged files keep their secrets, in any order, and each person has one number") {
    const TemporaryFolder folder;
    const auto file = [&](const char* name) {
        return folder.file(name);
    };
    REQUIRE(run_as("P01", file("a.sqlite")).code == 0);
    REQUIRE(run_as("P02", file("a.sqlite")).code == 0);
    REQUIRE(run_as("P03", file("b.sqlite")).code == 0);
    REQUIRE(run_as("P01", file("b.sqlite"), {"--session", "2", "--elsewhere"}).code == 0);
    ran({"merge", file("ab.sqlite"), file("a.sqlite"), file("b.sqlite")});
    ran({"merge", file("ba.sqlite"), file("b.sqlite"), file("a.sqlite")});
    const std::string people =
        "SELECT participant_code || ' ' || subject FROM participant ORDER BY 1";
    const std::string sessions = "SELECT uuid || secret FROM session UNION SELECT hex FROM secret";
    CHECK(values(file("ab.sqlite"), people) == values(file("ba.sqlite"), people));
    CHECK(values(file("ab.sqlite"), sessions) == values(file("ba.sqlite"), sessions));
    CHECK(values(file("ab.sqlite"), "SELECT hex FROM secret").size() == 2);
    const auto number = [&](const char* name) {
        return values(file(name),
                      "SELECT printf('%010d', subject) FROM participant WHERE participant_code = "
                      "'P01'")
            .at(0);
    };
    CHECK(number("ab.sqlite") == std::min(number("a.sqlite"), number("b.sqlite")));
    ran({"merge", file("ab.sqlite"), file("ab.sqlite"), file("b.sqlite")});
    CHECK(values(file("ab.sqlite"), sessions) == values(file("ba.sqlite"), sessions));
    ran({"verify", file("ab.sqlite")});
    for (const char* session : {"1", "2"}) {
        const Words words{"sequence",  kStudy,  "--participant", "P01",
                          "--session", session, "--csv",         "--db"};
        const auto drawn = [&](const char* from) {
            return ran(joined(words, {file(from)})).out;
        };
        CHECK(drawn("ab.sqlite") == drawn(*session == '1' ? "a.sqlite" : "b.sqlite"));
    }
}

TEST_CASE("a secret that is lost, or was changed by hand, is reported") {
    const TemporaryFolder folder;
    const std::string file = folder.file("study.sqlite");
    REQUIRE(run_as("P01", file).code == 0);
    ran({"verify", file});
    for (const std::string& edit : lines_in(test_text("edits/secrets.sql"))) {
        CAPTURE(edit);
        const std::string copy = copied(file, folder.file("copy.sqlite"));
        sql_edit(copy, fmt::format("PRAGMA foreign_keys = OFF; {}", edit));
        CHECK_THAT(ran({"verify", copy}, 1).out, Has("secret") || Has("plan_sha256"));
    }
    sql_edit(file, "PRAGMA foreign_keys = OFF; DELETE FROM secret");
    CHECK_THAT(run_as("P02", file).error, Has("its secret was removed"));
}
