#include "data/store/reader.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

TEST_CASE("the default study, whole: every condition equally often, forces lawful on every tick") {
    const RunFile file("shape_friction");
    data::Database database(file, data::Access::read);
    CHECK(lines(database,
                "SELECT count(*), min(n), max(n) FROM (SELECT count(*) AS n FROM analysis_trial "
                "WHERE counts AND phase = 'main' GROUP BY planned_object, friction)") ==
          "10 10 10 \n");
    CHECK(lines(database,
                "SELECT sum(phase = 'practice'), sum(phase = 'catch') FROM analysis_trial WHERE "
                "counts") == "10 4 \n");

    auto trial = database.prepare("SELECT trial_id, friction FROM analysis_trial WHERE counts");
    int outside = 0;
    int inside = 0;
    int unlawful = 0;
    double excess = -1.0;
    double highest_mu = 0.0;
    while (trial.step()) {
        const double mu_s = trial.text(1) == "on" ? 0.7 : 0.0;
        for (const engine::TickRecord& tick : data::TraceReader(database).read(trial.integer(0))) {
            if (tick.mode == engine::Mode::free) {
                ++outside;
                unlawful += tick.force == engine::Vec3{} && tick.command == engine::Vec3{} ? 0 : 1;
                continue;
            }
            ++inside;
            excess = std::max(excess, std::fabs(tick.tangential_force) - mu_s * tick.normal_force);
            highest_mu = std::max(highest_mu, tick.mu);
            const bool within = glm::length(tick.command) <= 10.0 * (1.0 + 1e-12);
            unlawful += tick.normal_force >= 0.0 && within ? 0 : 1;
        }
    }
    CHECK(unlawful == 0);
    CHECK(outside > 10'000);
    CHECK(inside > 10'000);
    CHECK(excess <= 1e-9);
    CHECK(highest_mu <= 0.7);
}
