#pragma once

#include "tests/support/random.hpp"

namespace palpate::stress {

/// Uniform in [lo, hi) along each axis.
template <class Point>
[[nodiscard]] Point any_point(tests::Random& random, double lo, double hi) {
    Point p{};
    for (int k = 0; k < Point::length(); ++k) {
        p[k] = random.in(lo, hi);
    }
    return p;
}

/// What random hands do in the plane and in space, in bouts of 5 to 104 ticks.
template <class Point>
class AnyHand {
public:
    AnyHand(const AnyHand&) = delete;
    AnyHand& operator=(const AnyHand&) = delete;
    virtual ~AnyHand() = default;

    [[nodiscard]] std::vector<Point> path(std::size_t ticks) {
        while (path_.size() < ticks) {
            const int some = 5 + random_->below(100);
            switch (bout()) {
                case 0:
                    wander(some);
                    break;
                case 1:
                    rest(some / 4 + 1);
                    break;
                case 2:
                    jump();
                    break;
                case 3:
                    press(some);
                    break;
                case 4:
                    falter();
                    break;
                default:
                    rub(some);
            }
        }
        path_.resize(ticks);
        return std::move(path_);
    }

protected:
    /// @param size  of the object, m   @param period  s, of a tick   @param gentle  as people move
    AnyHand(tests::Random& random, const Point& centre, double size, double period, bool gentle)
        : random_(&random),
          centre_(centre),
          size_(size),
          gentle_(gentle),
          fastest_(10.0 * period),
          at_(somewhere()) {}

    /// Which bout comes next, 0 to 7: those from 5 on rub.
    virtual int bout() { return random_->below(8); }
    /// Onto a place where something changes, or anywhere.
    virtual void jump() = 0;
    /// From outside at a place of the object, through it.
    virtual void press(int ticks) = 0;
    /// Perhaps ticks that are no numbers.
    virtual void falter() = 0;
    /// Along the object, at a depth that comes and goes.
    virtual void rub(int ticks) = 0;

    void go_to(const Point& h) {
        at_ = h;
        path_.push_back(h);
    }
    [[nodiscard]] Point somewhere() {
        return centre_ + size_ * any_point<Point>(*random_, -0.7, 0.7);
    }
    /// A step of one tick, m: some share of the object, 10 m/s at most.
    [[nodiscard]] double any_step() {
        return std::min(fastest_, size_ * random_->decade(-6.0, gentle_ ? -2.0 : -0.3));
    }
    /// Straight from outside, through what is pressed, to the aim or beyond.
    void press_on(const Point& on, const Point& from, const Point& aim, int ticks) {
        const Point to = on + random_->in(0.5, 1.5) * (aim - on);
        const double way = std::max(glm::length(to - from), 1e-300);
        const double step = std::min(1.0 / ticks, (gentle_ ? any_step() : fastest_) / way);
        for (int i = 0; i < ticks; ++i) {
            go_to(from + (i * step) * (to - from));
        }
    }

    tests::Random* random_;
    Point centre_;
    double size_;
    bool gentle_;
    double fastest_;  ///< m a tick: 10 m/s
    Point at_;
    std::vector<Point> path_;

private:
    void wander(int ticks) {
        const double step = any_step();
        Point speed{};
        for (int i = 0; i < ticks; ++i) {
            speed = 0.95 * speed + (0.3 * step) * any_point<Point>(*random_, -1.0, 1.0);
            if (glm::length(at_ + speed - centre_) > size_) {
                speed = -0.5 * speed;
            }
            go_to(at_ + speed);
        }
    }
    void rest(int ticks) {
        for (int i = 0; i < ticks; ++i) {
            go_to(at_);
        }
    }
};

}  // namespace palpate::stress
