#include "protocols/file/protocol_file.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/store/reader.hpp"
#include "tests/support/program.hpp"
#include "tests/support/scenes.hpp"

namespace {

Words run(const std::string& file, const std::string& device) {
    return run_words("shape_friction_demo", "P1", file, {"--headless", "--device", device});
}

}  // namespace

TEST_CASE("every recorded force comes back to the bit from the database alone") {
    const TemporaryFile file("a.sqlite");
    ran(run(file, "sim"));
    data::Database database(file, data::Access::read);
    auto text = database.first("SELECT protocol_toml FROM study");
    const protocols::Protocol protocol = protocols::parse_protocol(text.text(0), "stored");
    auto trial = database.prepare(
        "SELECT trial_id, felt_object, friction, slip_decay, heal_decay FROM presentation");
    int replayed = 0;
    while (trial.step()) {
        const auto index = [&](const auto& list, const std::string& name) {
            return static_cast<std::size_t>(
                std::find_if(list.begin(), list.end(),
                             [&](const auto& one) { return one.name == name; }) -
                list.begin());
        };
        engine::Scene scene = protocols::make_scene(
            protocol,
            {index(protocol.objects, trial.text(1)), index(protocol.frictions, trial.text(2))});
        scene.restore_decay({trial.real(3), trial.real(4)});
        engine::ContactState state;
        for (const engine::TickRecord& tick : data::TraceReader(database).read(trial.integer(0))) {
            const engine::Contact contact = scene.tick(state, engine::Vec2(tick.hip));
            REQUIRE(std::memcmp(&contact.force, &tick.force, sizeof contact.force) == 0);
            REQUIRE(std::memcmp(&contact.go, &tick.go, sizeof contact.go) == 0);
            REQUIRE(contact.mu == tick.mu);
            REQUIRE(contact.mode == tick.mode);
            ++replayed;
        }
    }
    CHECK(replayed > 40'000);
}

TEST_CASE("a session on a replayed hand feels and answers as the recorded one") {
    const TemporaryFolder folder;
    const std::string first = folder.file("a.sqlite");
    const std::string second = folder.file("b.sqlite");
    ran(run(first, "sim"));
    ran(run(second, "replay:" + first));
    data::Database a(first, data::Access::read);
    data::Database b(second, data::Access::read);
    const auto trials_a = data::answered_trials(a);
    const auto trials_b = data::answered_trials(b);
    REQUIRE(trials_a.size() == 10);
    REQUIRE(trials_b.size() == 10);
    for (std::size_t i = 0; i < 10; ++i) {
        const auto one = data::TraceReader(a).read(trials_a[i]);
        const auto two = data::TraceReader(b).read(trials_b[i]);
        REQUIRE(one.size() == two.size());
        for (std::size_t k = 0; k < one.size(); ++k) {
            REQUIRE(std::memcmp(&one[k].force, &two[k].force, sizeof one[k].force) == 0);
            REQUIRE(std::memcmp(&one[k].hip, &two[k].hip, sizeof one[k].hip) == 0);
        }
    }
    const auto choices = [](data::Database& database) {
        return database
            .first(
                "SELECT group_concat(chosen_object) FROM (SELECT chosen_object FROM analysis_trial "
                "WHERE counts ORDER BY plan_position)")
            .text(0);
    };
    CHECK(choices(a) == choices(b));
}

TEST_CASE("one named trial can be replayed for all") {
    const TemporaryFolder folder;
    const std::string first = folder.file("a.sqlite");
    ran(run(first, "sim"));
    ran(run(folder.file("b.sqlite"), "replay:" + first + ":3"));
    CHECK_THAT(ran(run(folder.file("c.sqlite"), "replay:" + first + ":333"), 2).error,
               Has("no trial 333"));
}
