from ._core import Params, PointLike, PoseLike

def go_to(
    pose: PoseLike,
    target: PointLike,
    *,
    v_max: float,
    omega_max: float,
    dt: float,
    v_reverse_max: float = 0.0,
    params: Params | None = None,
) -> tuple[float, float]: ...

__all__ = ["go_to"]
