// City, robot and collision rule of the comparison: same as examples/planner_quality.rs of evader_rrt_star.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace city {

// The disc may touch.
inline constexpr double kRadius = 0.105;
inline constexpr double kHalf = 9.5;
inline constexpr double kTouching = 1e-9;
inline constexpr double kQueries[3][4] = {
    {-4.5, 7.5, 9.0, 0.0}, {-7.5, -7.3, 7.3, 7.5}, {1.5, -6.0, -6.0, 4.5}};

struct Point {
    double x, y;
};

struct Piece {
    std::vector<Point> corners;  // counter-clockwise
    double min_x, min_y, max_x, max_y;
};

inline Piece piece(std::vector<Point> corners) {
    Piece p{std::move(corners), 1e9, 1e9, -1e9, -1e9};
    for (const Point &c : p.corners) {
        p.min_x = std::min(p.min_x, c.x);
        p.min_y = std::min(p.min_y, c.y);
        p.max_x = std::max(p.max_x, c.x);
        p.max_y = std::max(p.max_y, c.y);
    }
    return p;
}

inline Piece box(double x0, double y0, double x1, double y1) {
    return piece({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}});
}

inline std::vector<Piece> pieces() {
    std::vector<Piece> all;
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            all.push_back(box(3.0 * i - 1, 3.0 * j - 1, 3.0 * i + 1, 3.0 * j + 1));
    all.push_back(box(-9, -9, -8, 9));
    all.push_back(box(-9, -9, 9, -8));
    all.push_back(box(-9, 8, 9, 9));
    all.push_back(box(8, -8.75, 9, -1.25));
    all.push_back(box(8, 1.25, 9, 8.75));
    all.push_back(piece({{-8, -8}, {-7.5, -8}, {-8, -7.5}}));
    all.push_back(piece({{8, -8}, {8, -7.5}, {7.5, -8}}));
    all.push_back(piece({{8, 8}, {7.5, 8}, {8, 7.5}}));
    all.push_back(piece({{-8, 8}, {-8, 7.5}, {-7.5, 8}}));
    return all;
}

inline double squared(double dx, double dy) { return dx * dx + dy * dy; }

inline double pointSegment(Point p, Point a, Point b) {
    const double dx = b.x - a.x, dy = b.y - a.y, length = squared(dx, dy);
    double t = length > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length : 0;
    t = std::clamp(t, 0.0, 1.0);
    return squared(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

inline double cross(Point o, Point a, Point b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

inline bool contains(const Piece &piece, Point p) {
    const std::size_t n = piece.corners.size();
    for (std::size_t i = 0; i < n; ++i)
        if (cross(piece.corners[i], piece.corners[(i + 1) % n], p) < 0) return false;
    return true;
}

class World {
public:
    World() : pieces_(pieces()) {}

    bool isFree(Point a, Point b) const {
        // The edge of the world is a wall.
        const double most = kHalf - kRadius + kTouching;
        for (double c : {a.x, a.y, b.x, b.y})
            if (std::abs(c) > most) return false;
        const double least = (kRadius - kTouching) * (kRadius - kTouching);
        const double x0 = std::min(a.x, b.x) - kRadius, x1 = std::max(a.x, b.x) + kRadius;
        const double y0 = std::min(a.y, b.y) - kRadius, y1 = std::max(a.y, b.y) + kRadius;
        for (const Piece &piece : pieces_) {
            if (piece.max_x < x0 || piece.min_x > x1 || piece.max_y < y0 || piece.min_y > y1)
                continue;
            if (contains(piece, a)) return false;
            const std::size_t n = piece.corners.size();
            for (std::size_t i = 0; i < n; ++i) {
                const Point c = piece.corners[i], d = piece.corners[(i + 1) % n];
                const bool crosses = cross(a, b, c) * cross(a, b, d) < 0 &&
                                     cross(c, d, a) * cross(c, d, b) < 0;
                if (crosses) return false;
                const double distance =
                    std::min(std::min(pointSegment(a, c, d), pointSegment(b, c, d)),
                             std::min(pointSegment(c, a, b), pointSegment(d, a, b)));
                if (distance < least) return false;
            }
        }
        return true;
    }

private:
    std::vector<Piece> pieces_;
};

}  // namespace city
