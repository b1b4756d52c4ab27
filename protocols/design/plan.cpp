#include "protocols/design/plan.hpp"

namespace palpate::protocols {

void place(std::vector<PlannedTrial>& trials, std::size_t practice, std::size_t break_every) {
    std::size_t main = 0;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const bool counts = trials[i].phase != Phase::practice;
        const bool due = counts && main > 0 && break_every > 0 && main % break_every == 0;
        trials[i].position = i;
        trials[i].break_before = due || (practice > 0 && i == practice);
        main += counts ? 1 : 0;
    }
}

std::vector<std::size_t> objects_of(const Protocol& protocol, bool pictured) {
    std::vector<std::size_t> objects;
    for (std::size_t i = 0; i < protocol.objects.size(); ++i) {
        if (protocol.objects[i].pictured == pictured) {
            objects.push_back(i);
        }
    }
    return objects;
}

std::vector<Condition> factorial(const Protocol& protocol, std::size_t repetitions) {
    std::vector<Condition> conditions;
    for (const std::size_t object : objects_of(protocol, true)) {
        for (std::size_t friction = 0; friction < protocol.frictions.size(); ++friction) {
            conditions.insert(conditions.end(), repetitions, Condition{object, friction});
        }
    }
    return conditions;
}

}  // namespace palpate::protocols
