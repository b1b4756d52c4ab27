#include "tests/stress/any_hand.hpp"
#include "tests/stress/stress_scene.hpp"
#include "tests/support/frame.hpp"

namespace palpate::stress {
namespace {

using namespace palpate::engine;
using tests::Random;

engine::Box<2> box_of(const Outline& outline) {
    engine::Box<2> box = outline.spans().front().box();
    for (const auto& span : outline.spans()) {
        box.add(span.box());
    }
    return box;
}

class Hand : public AnyHand<Vec2> {
public:
    Hand(Random& random, const Outline& outline, const HandSpec& spec)
        : AnyHand(random, box_of(outline).middle(), size_of(outline), spec.period, spec.gentle),
          outline_(&outline),
          spec_(spec) {}

private:
    int bout() override {
        if (spec_.gentle) {
            stumble();  // a tick that is refused ends the contact
        }
        return spec_.leaps ? 2 : AnyHand::bout();
    }
    void falter() override {
        if (spec_.broken && random_->coin()) {
            stumble();
        }
    }

    [[nodiscard]] std::size_t any_span() {
        return static_cast<std::size_t>(random_->below(static_cast<int>(outline_->spans().size())));
    }

    void jump() override {
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

    void rub(int ticks) override {
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

    /// To the outline's centre of curvature, or as deep.
    void press(int ticks) override {
        const std::size_t span = any_span();
        const double u =
            random_->below(4) == 0 ? (random_->coin() ? 0.0 : 1.0) : random_->in(0.0, 1.0);
        const engine::Frame frame = engine::frame_at(outline_->spans()[span], u);
        const Vec2 from = frame.point + (size_ * random_->decade(-4.0, -0.5)) * frame.normal;
        const Vec2 aim = random_->coin()
                           ? curvature_centre(span, u)
                           : frame.point - (size_ * random_->decade(-4.0, -0.3)) * frame.normal;
        press_on(frame.point, from, aim, ticks);
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

    const Outline* outline_;
    HandSpec spec_;
};

}  // namespace

double size_of(const Outline& outline) {
    return glm::length(box_of(outline).size());
}

std::vector<Vec2> random_path(Random& random, const Outline& outline, const HandSpec& spec) {
    return Hand(random, outline, spec).path(spec.ticks);
}

}  // namespace palpate::stress
