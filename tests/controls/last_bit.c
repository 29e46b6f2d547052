/* Elementary functions of the C library with the last bit inverted, for LD_PRELOAD: a history that changes with this
 * library depends on the C library of the machine. NaN, infinities and zero stay. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdint.h>
#include <string.h>

static double other(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    if (x - x == 0 && x != 0) bits ^= 1;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static float otherf(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    if (x - x == 0 && x != 0) bits ^= 1;
    memcpy(&x, &bits, sizeof x);
    return x;
}

#define NEXT(name, type) \
    static __typeof__(type) *next; \
    if (!next) next = (__typeof__(type) *)dlsym(RTLD_NEXT, #name)
#define ONE(name) \
    double name(double x) { NEXT(name, double(double)); return other(next(x)); } \
    float name##f(float x) { NEXT(name##f, float(float)); return otherf(next(x)); }
#define TWO(name) \
    double name(double x, double y) { NEXT(name, double(double, double)); return other(next(x, y)); } \
    float name##f(float x, float y) { NEXT(name##f, float(float, float)); return otherf(next(x, y)); }

ONE(sin) ONE(cos) ONE(tan) ONE(asin) ONE(acos) ONE(atan)
ONE(sinh) ONE(cosh) ONE(tanh) ONE(asinh) ONE(acosh) ONE(atanh)
ONE(exp) ONE(exp2) ONE(expm1) ONE(log) ONE(log2) ONE(log10) ONE(log1p) ONE(cbrt)
TWO(atan2) TWO(pow) TWO(hypot)

void sincos(double x, double *s, double *c) {
    NEXT(sincos, void(double, double *, double *));
    next(x, s, c);
    *s = other(*s);
    *c = other(*c);
}

void sincosf(float x, float *s, float *c) {
    NEXT(sincosf, void(float, float *, float *));
    next(x, s, c);
    *s = otherf(*s);
    *c = otherf(*c);
}
