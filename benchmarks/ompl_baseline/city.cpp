// The collision test of the city for other languages.

#include "city.hpp"

extern "C" bool city_is_free(double ax, double ay, double bx, double by) {
    static const city::World world;
    return world.isFree({ax, ay}, {bx, by});
}
