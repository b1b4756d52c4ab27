#include <cmath>

#include "protocols/procedure/quest.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

TEST_CASE("QUEST runs a published sequence", "[quest][golden]") {
    // Intensities and estimates tabulated in PsychoPy's test of its QuestHandler (2017), computed by the
    // QUEST of the Vision Egg, a translation of D. Pelli's. Two right, two wrong, and again.
    Quest quest(
        {.guess = 50.0, .sd = 50.0, .range = 100.0, .lowest = 0.0, .highest = 100.0, .trials = 10});
    constexpr std::array kShown{50.0,
                                45.139710407074872,
                                37.291086503930742,
                                58.297413127139947,
                                80.182967131096547,
                                75.295251409003527,
                                71.57627192423783,
                                79.881680484036906,
                                90.712313302815517,
                                88.265808957695796};
    for (std::size_t i = 0; i < kShown.size(); ++i) {
        CAPTURE(i);
        const std::vector<double> x = i == 0 ? std::vector<double>{50.0} : quest.next();
        CHECK(x[0] == Approx(kShown[i]).margin(1e-3));
        quest.update(std::vector<double>{kShown[i]}, i % 4 < 2 ? 1 : 0);
    }
    CHECK(quest.mean() == Approx(86.0772169427).margin(1e-3));
    CHECK(quest.mode() == Approx(80.11).margin(1e-9));
    CHECK(quest.quantile(quest.quantile_order()) == Approx(86.3849031085).margin(1e-3));
    CHECK(quest.finished());
}
