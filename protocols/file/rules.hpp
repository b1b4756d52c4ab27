#pragma once

#include <string>
#include <utility>

#include <fmt/core.h>

#include "protocols/file/schema.hpp"
#include "protocols/protocol/protocol.hpp"

/// Private to protocols/file: the table [procedure], and what must hold across keys once every
/// value by itself is right.
namespace palpate::protocols {

/// A check of what a protocol says: each problem is noted where its key stands.
class RuleCheck {
public:
    RuleCheck(const Protocol& protocol, const Places& places, Problems& problems)
        : protocol_(protocol), places_(places), problems_(problems) {}

protected:
    void add(const std::string& path, std::string what) {
        problems_.add(places_.of(path), std::move(what));
    }
    /// If it is `wrong`, in a sentence as fmt::format() makes it. @return wrong
    template <class... Values>
    bool add_if(bool wrong,
                const std::string& path,
                fmt::format_string<Values...> what,
                Values&&... values) {
        if (wrong) {
            add(path, fmt::format(what, std::forward<Values>(values)...));
        }
        return wrong;
    }

    const Protocol& protocol_;
    const Places& places_;
    Problems& problems_;
};

/// Names are unique, the times are in order, the run limits are feasible; and all that follows
/// here.
void check_rules(const Protocol& protocol, const Places& places, Problems& problems);

/// Pictures differ; two curves fit their chords and leave room for the object; a free form is
/// closed, runs clockwise and does not meet itself; each is of a size to feel, within 1 m of the
/// origin, and leaves the start of a trial outside.
void check_objects(const Protocol& protocol, const Places& places, Problems& problems);

/// Largest |curvature| * chord / 2: the sine of an arc's half sweep. 0.95 is a sweep of 144
/// degrees; beyond it the two curves look like circles, and the arc comes near what one curve can
/// hold.
inline constexpr double kMaxHalfSine = 0.95;

/// Reads the table [procedure]: the keys of AdaptiveSpec and those of a procedure file. What
/// follows from the rule is filled in, and where every key stands. @param entry of the table, in
/// the protocol's file
void read_adaptive(const Entry& entry, Problems& problems, Places& places, Protocol& protocol);

/// What [procedure], [[run]], [response], [design], objects and frictions need of each other.
void check_adaptive(const Protocol& protocol, const Places& places, Problems& problems);

}  // namespace palpate::protocols
