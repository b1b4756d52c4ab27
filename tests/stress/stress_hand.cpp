#include "tests/stress/stress_scene.hpp"
#include "tests/support/frame.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using tests::Random;

constexpr double kFastest = 10.0;  // m/s

engine::Box<2> box_of(const Outline& outline) {
    engine::Box<2> box = outline.spans().front().box();
    for (const auto& span : outline.spans()) {
        box.add(span.box());
    }
    return box;
}

class Hand {
public:
    Hand(Random& random, const Outline& outline, const HandSpec& spec)
        : random_(&random), outline_(&outline), spec_(spec), size_(size_of(outline)) {
        const engine::Box<2> box = box_of(outline);
        centre_ = box.middle();
        at_ = somewhere();
    }

    std::vector<Vec2> path() {
        while (path_.size() < spec_.ticks) {
            const int ticks = 5 + random_->below(100);
            if (spec_.gentle) {
                stumble();  // a tick that is refused ends the contact
            }
            switch (spec_.leaps ? 2 : random_->below(8)) {
                case 0:
                    wander(ticks);
                    break;
                case 1:
                    rest(ticks / 4 + 1);
                    break;
                case 2:
                    jump();
                    break;
                case 3:
                    press(ticks);
                    break;
                case 4:
                    if (spec_.broken && random_->coin()) {
                        stumble();
                    }
                    break;
                default:
                    rub(ticks);
            }
        }
        path_.resize(spec_.ticks);
        return std::move(path_);
    }

private:
    void go_to(const Vec2& h) {
        at_ = h;
        path_.push_back(h);
    }

    [[nodiscard]] Vec2 somewhere() { return centre_ + size_ * random_->point(-0.7, 0.7); }
    [[nodiscard]] std::size_t any_span() {
        return static_cast<std::size_t>(random_->below(static_cast<int>(outline_->spans().size())));
    }
    /// A step of one tick, m: some share of the object, 10 m/s at most.
    [[nodiscard]] double any_step() {
        return std::min(kFastest * spec_.period,
                        size_ * random_->decade(-6.0, spec_.gentle ? -2.0 : -0.3));
    }

    void wander(int ticks) {
        const double step = any_step();
        Vec2 speed{};
        for (int i = 0; i < ticks; ++i) {
            speed = 0.95 * speed + (0.3 * step) * random_->point(-1.0, 1.0);
            const Vec2 next = at_ + speed;
            if (glm::length(next - centre_) > size_) {
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

    /// Onto a place where something changes, or anywhere.
    void jump() {
        const auto& spans = outline_->spans();
        const auto& seams = outline_->seams();
        switch (random_->below(6)) {
            case 0:
                if (!seams.empty()) {
                    const auto i = random_->below(static_cast<int>(seams.size()));
                    go_to(seams[static_cast<std::size_t>(i)].point);
                }
                break;
            case 1: {
                const auto& span = spans[any_span()];
                const auto i = random_->below(span.degree() + 1);
                go_to(span.point(static_cast<std::size_t>(i)));
                break;
            }
            case 2:
                go_to(spans[any_span()].at(random_->in(0.0, 1.0)).point);
                break;
            case 3:
                go_to(curvature_centre(any_span(), random_->in(0.0, 1.0)));
                break;
            case 4:
                go_to(centre_ + size_ * random_->decade(0.0, spec_.far ? 150.0 : 3.0) *
                                    random_->point(-1.0, 1.0));
                break;
            default:
                go_to(somewhere());
        }
    }

    [[nodiscard]] Vec2 curvature_centre(std::size_t span, double u) {
        const engine::Frame frame = engine::frame_at(outline_->spans()[span], u);
        const double radius = 1.0 / frame.curvature;
        const bool usable = std::isfinite(radius) && std::fabs(radius) < 1e3 * size_;
        return frame.point - (usable ? radius : random_->in(-0.1, 0.1) * size_) * frame.normal;
    }

    /// Along the outline, at a depth that comes and goes.
    void rub(int ticks) {
        std::size_t span = any_span();
        double u = random_->in(0.0, 1.0);
        double way = random_->coin() ? 1.0 : -1.0;
        const double step = any_step();
        const double deepest = size_ * random_->decade(-6.0, -0.5);
        const double phase = random_->in(0.0, 6.0);
        const double waves = random_->in(0.0, 20.0);
        for (int i = 0; i < ticks; ++i) {
            const engine::Frame frame = engine::frame_at(outline_->spans()[span], u);
            const double share = static_cast<double>(i) / ticks;
            const double depth = deepest * (0.7 + std::sin(phase + waves * share));
            go_to(frame.point - depth * frame.normal);
            u += way * std::min(step / std::max(frame.speed, 1e-300), 0.3);
            if (u >= 0.0 && u <= 1.0) {
                continue;
            }
            const auto seam = outline_->seam_beyond(span, way > 0.0);
            if (seam && random_->below(8) != 0) {
                const engine::Seam& vertex = outline_->seams()[*seam];
                span = way > 0.0 ? vertex.after : vertex.before;
                u = way > 0.0 ? 0.0 : 1.0;
            } else {
                way = -way;
                u = std::clamp(u, 0.0, 1.0);
            }
        }
    }

    /// Straight from outside at a place of the outline, through it, to its centre of curvature or
    /// beyond.
    void press(int ticks) {
        const std::size_t span = any_span();
        const double u =
            random_->below(4) == 0 ? (random_->coin() ? 0.0 : 1.0) : random_->in(0.0, 1.0);
        const engine::Frame frame = engine::frame_at(outline_->spans()[span], u);
        const Vec2 from = frame.point + (size_ * random_->decade(-4.0, -0.5)) * frame.normal;
        const Vec2 aim = random_->coin()
                           ? curvature_centre(span, u)
                           : frame.point - (size_ * random_->decade(-4.0, -0.3)) * frame.normal;
        const Vec2 to = frame.point + random_->in(0.5, 1.5) * (aim - frame.point);
        const double way = std::max(glm::length(to - from), 1e-300);
        const double fastest = spec_.gentle ? any_step() : kFastest * spec_.period;
        const double step = std::min(1.0 / ticks, fastest / way);
        for (int i = 0; i < ticks; ++i) {
            go_to(from + (i * step) * (to - from));
        }
    }

    /// A tick that is no number, and perhaps more of them.
    void stumble() {
        constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        const int ticks = 1 + random_->below(3);
        for (int i = 0; i < ticks; ++i) {
            const double bad = random_->coin() ? kNan : random_->coin() ? kInfinity : -kInfinity;
            path_.push_back(random_->coin() ? Vec2{bad, at_.y} : Vec2{at_.x, bad});
        }
    }

    Random* random_;
    const Outline* outline_;
    HandSpec spec_;
    double size_;
    Vec2 centre_{};
    Vec2 at_{};
    std::vector<Vec2> path_;
};

}  // namespace

double size_of(const Outline& outline) {
    return glm::length(box_of(outline).size());
}

std::vector<Vec2> random_path(Random& random, const Outline& outline, const HandSpec& spec) {
    return Hand(random, outline, spec).path();
}

}  // namespace palpate::stress
