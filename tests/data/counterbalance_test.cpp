#include "protocols/design/counterbalance.hpp"
#include "protocols/file/protocol_file.hpp"
#include "data/store/session_store.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

namespace {

/// The first trial of a session has begun: from now on it keeps its row.
void begin(data::Database& database, std::int64_t session) {
    database.run(
        "INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc) "
        "SELECT 'test', ?1, 0, 1 + count(*), 'interrupted', '' FROM trial WHERE session_id = ?1",
        session);
}

/// Opens the session that a rig would open for this participant, and begins its first trial.
protocols::Plan open_plan(data::Database& database,
                          const protocols::Protocol& protocol,
                          const std::string& participant,
                          data::RunKind kind,
                          std::size_t number = 1) {
    data::SessionSpec spec = session_spec(protocol, participant, number);
    spec.kind = kind;
    begin(database, data::plan_and_open_session(database, spec).id);
    return spec.plan;
}

/// The same: its pictures.
template <class... More>
std::vector<std::size_t> open(More&&... more) {
    return open_plan(std::forward<More>(more)...).picture_order;
}

/// A study's file as histories grow it, and who has which row by the rules alone.
struct GrownFile {
    NewDatabase database{};
    protocols::Protocol protocol = small_protocol();
    /// Of each person, in the order of sessions.
    std::map<std::string, std::vector<std::vector<std::size_t>>> orders{};
    std::map<std::string, std::vector<std::size_t>> rows{};  ///< of those who really ran
    std::size_t left = 0;  ///< were withdrawn since, and nobody came for them yet

    std::vector<std::size_t> run(const std::string& person, data::RunKind kind) {
        auto& all = orders[person];
        return all.emplace_back(open(database, protocol, person, kind, all.size() + 1));
    }
    void try_out(const std::string& person, data::RunKind kind) {
        const auto order = run(person, kind);
        CHECK(order == orders[person].front());
    }
    std::size_t uses(const std::vector<std::size_t>& order) const {
        return static_cast<std::size_t>(
            std::ranges::count(rows, order, [](const auto& one) { return one.second; }));
    }
    /// Of the row used least and of the one used most.
    std::pair<std::size_t, std::size_t> range() const {
        std::vector<std::size_t> all;
        for (const auto& order : picture_rows(protocol)) {
            all.push_back(uses(order));
        }
        const auto [least, most] = std::ranges::minmax(all);
        return {least, most};
    }
    void really_run(const std::string& person) {
        const std::size_t least = range().first;
        const auto order = run(person, data::RunKind::real);
        if (const auto has = rows.find(person); has != rows.end()) {
            CHECK(order == has->second);
            return;
        }
        CHECK(uses(order) == least);
        rows[person] = order;
        left -= left > 0 ? 1 : 0;
    }
    void withdraw(const std::string& person) {
        database.run(
            "UPDATE session SET withdrawn_reason = 'asleep' WHERE session_kind = 'real' AND "
            "participant_id = (SELECT participant_id FROM participant WHERE participant_code = ?1)",
            person);
        left += rows.erase(person);
    }
};

}  // namespace

TEST_CASE("those who really ran decide the next row of pictures, simulated ones do not") {
    NewDatabase database;
    const protocols::Protocol protocol = small_protocol();
    const std::size_t rows = picture_rows(protocol).size();
    REQUIRE(rows == 6);
    for (int i = 0; i < 8; ++i) {
        open(database, protocol, fmt::format("S{}", i), data::RunKind::simulated);
        open(database, protocol, fmt::format("L{}", i), data::RunKind::pilot);
    }
    CHECK(data::orders_of(database, data::Balanced::pictures, "small", {"R0", 1}).others.empty());
    std::set<std::vector<std::size_t>> orders;
    for (std::size_t i = 0; i < rows; ++i) {
        orders.insert(open(database, protocol, fmt::format("R{}", i), data::RunKind::real));
    }
    CHECK(orders.size() == rows);
    CHECK(data::orders_of(database, data::Balanced::pictures, "small", {"R0", 1}).others.size() ==
          rows - 1);
    CHECK(data::orders_of(database, data::Balanced::pictures, "other", {"R0", 1}).others.empty());
}

TEST_CASE("a session goes on with its own pictures, and so does the participant's next one") {
    NewDatabase database;
    const protocols::Protocol protocol = small_protocol();
    const auto first = open(database, protocol, "R0", data::RunKind::real);
    for (int i = 1; i < 12; ++i) {
        open(database, protocol, fmt::format("R{}", i), data::RunKind::real);
        // Another plan would be refused here.
        CHECK(open(database, protocol, "R0", data::RunKind::real) == first);
    }
    CHECK(open(database, protocol, "R0", data::RunKind::real, 2U) == first);
    CHECK(data::orders_of(database, data::Balanced::pictures, "small", {"R1", 1}).others.size() ==
          11);
}

TEST_CASE("real participants begin with each friction in turns, whoever else ran") {
    SEED(std::uint64_t{6});
    NewDatabase database;
    protocols::Protocol protocol = small_protocol(2);
    protocol.seed = seed;
    // An older version of the study, in which the frictions were mixed, counts for nothing.
    open(database, protocol, "OLD", data::RunKind::real);
    protocol.design.blocks = 2;
    protocol.design.friction_blocks = protocols::FrictionBlocks::abba;
    const auto begins = [&](const std::string& person, data::RunKind kind, std::size_t number) {
        return first_round(protocol, open_plan(database, protocol, person, kind, number)).front();
    };
    std::vector<std::size_t> begun;
    for (int i = 0; i < 8; ++i) {
        begins(fmt::format("S{}", i), data::RunKind::simulated, 1);
        begun.push_back(begins(fmt::format("R{}", i), data::RunKind::real, 1));
        // The same session goes on: another plan would be refused.
        CHECK(begins("R0", data::RunKind::real, 1) == begun[0]);
        if (i % 2 == 1) {
            CHECK(begun[begun.size() - 1] != begun[begun.size() - 2]);
        }
    }
    CHECK(begins("R0", data::RunKind::real, 2) == begun[0]);
}

TEST_CASE("whoever leaves before the first trial uses up no row, and is planned anew when back") {
    SEED(std::uint64_t{8});
    NewDatabase database;
    protocols::Protocol protocol = small_protocol();
    protocol.seed = seed;
    const std::size_t rows = picture_rows(protocol).size();
    data::SessionSpec spec = session_spec(protocol, "LEFT");
    spec.kind = data::RunKind::real;
    {
        const auto opened = data::plan_and_open_session(database, spec);
        CHECK(
            data::orders_of(database, data::Balanced::pictures, "small", {"R0", 1}).others.size() ==
            1);
    }
    CHECK(data::orders_of(database, data::Balanced::pictures, "small", {"R0", 1}).others.empty());
    std::set<std::vector<std::size_t>> orders;
    for (std::size_t i = 0; i + 1 < rows; ++i) {
        orders.insert(open(database, protocol, fmt::format("R{}", i), data::RunKind::real));
    }
    CHECK(orders.size() == rows - 1);
    // The last row is left for whoever comes back, whichever it was before; a note on the session
    // stays.
    database.execute(
        "INSERT INTO event (session_id, event_kind, text, at_utc, trials_begun) SELECT "
        "min(session_id), 'note', 'late', '', 0 FROM session");
    orders.insert(open(database, protocol, "LEFT", data::RunKind::real));
    CHECK(orders.size() == rows);
    // With other words too: nobody has felt anything of it yet.
    data::SessionSpec other = session_spec(protocol, "AGAIN");
    static_cast<void>(data::plan_and_open_session(database, other));
    other.kind = data::RunKind::pilot;
    other.seed += 1;
    begin(database, data::plan_and_open_session(database, other).id);
    other.seed += 1;
    CHECK_THROWS_AS(data::plan_and_open_session(database, other), data::StoreError);
    CHECK(count(database, "event WHERE event_kind = 'note'") == 1);
    const std::int64_t again = count(database, "event WHERE event_kind = 'planned again'");
    CHECK((again == 1 || again == 2));
    CHECK(count(database, "session") == static_cast<std::int64_t>(rows + 1));
}

TEST_CASE("whatever was rehearsed, piloted, withdrawn and begun again, real rows stay in balance") {
    SEEDED(random, std::uint64_t{6});
    GrownFile file;
    file.protocol.seed = seed;
    for (int step = 0; step < 40; ++step) {
        const std::string person = fmt::format("P{}", random.below(10));
        switch (random.below(6)) {
            case 0:
                file.try_out(person, data::RunKind::simulated);
                break;
            case 1:
                file.try_out(person, data::RunKind::pilot);
                break;
            case 2:
                file.withdraw(person);
                break;
            default:
                file.really_run(person);
        }
        const auto [least, most] = file.range();
        CHECK(most - least <= 1 + file.left);
    }
}
