#include "protocols/design/plan.hpp"

namespace palpate::protocols {

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
