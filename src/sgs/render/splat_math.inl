// SPDX-FileCopyrightText: The Spectral GS-SLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What happens to one Gaussian between world and image, forward and backward: EWA projection
// (Zwicker et al., EWA Splatting, 2002; Kerbl et al., 3D Gaussian Splatting, 2023) and its
// derivatives. Written once for every renderer: V is a number (reference) or a vector of lanes
// (SIMD kernels), S the scalar type of the camera's View (view.h).
//
// Include it inside a namespace, once per instruction set, after declaring there
//   SGS_SPLAT_INLINE, mul_add(a, b, c) = a b + c, neg_mul_add(a, b, c) = c - a b, square_root,
//   exp2_of, log2_of, minimum, maximum, one_where_equal(a, b)
// for V. No include guard on purpose.

constexpr float kLowPass_px2 = 0.3f;  // added to the image covariance's diagonal
constexpr float kMaxAlpha = 0.99f;
constexpr float kLog2Of255 = 7.994353436858858f;
constexpr float kLog2E = 1.4426950408889634f;
constexpr float kLn2 = 0.6931471805599453f;
constexpr float kMaxScale_m = 1e3f;       // larger standard deviations are nonsense
constexpr float kMaxVariance_px2 = 1e9f;  // of the projected Gaussian
constexpr float kMaxColor = 1e4f;

template <class V>
struct CameraPoint {
  V x, y, z, inv_z, u, v;
};

// Parameters of a Gaussian as far as its shape is concerned.
template <class V>
struct Splat {
  V mean[3], log_scale[3], rotation[4], opacity_logit;
};

template <class V>
struct Projection {
  V uc, vc;          // clamped tangents
  V scale[3];        // standard deviations
  V q[4], inv_norm;  // unit quaternion and 1 / norm of the raw one
  V Q[9];            // its rotation matrix
  V j0, j1;          // fx / z, fy / z
  V U[6];            // J R: 2x3
  V M[6];            // J R Q diag(scale): 2x3, image covariance = M M^T + low-pass
  V cov_xx, cov_xy, cov_yy;
  V conic_xx, conic_xy, conic_yy;  // its inverse
  V opacity, log2_opacity;
  V mean_x, mean_y;  // pixels
};

// Sums over the pixels of one Gaussian. With h = alpha dL/dalpha and d = pixel - mean.
template <class V>
struct ImageGradient {
  V h, hx, hy, hxx, hxy, hyy, rgb[3], z;
};

template <class V>
struct SplatGradient {
  V mean[3], log_scale[3], rotation[4], opacity_logit;
  V twist[6];  // of the camera, rotation first, T_world_camera * exp(xi)
};

template <class V>
SGS_SPLAT_INLINE V dot3(V a0, V b0, V a1, V b1, V a2, V b2) {
  return mul_add(a0, b0, mul_add(a1, b1, a2 * b2));
}

template <class V, class S>
SGS_SPLAT_INLINE CameraPoint<V> to_camera(const View<S>& view, const V (&mean)[3]) {
  CameraPoint<V> p;
  const S* R = view.R;
  p.x = V(view.t[0]) + dot3(V(R[0]), mean[0], V(R[1]), mean[1], V(R[2]), mean[2]);
  p.y = V(view.t[1]) + dot3(V(R[3]), mean[0], V(R[4]), mean[1], V(R[5]), mean[2]);
  p.z = V(view.t[2]) + dot3(V(R[6]), mean[0], V(R[7]), mean[1], V(R[8]), mean[2]);
  p.inv_z = V(S(1)) / maximum(p.z, V(S(0.5f * kNearest_m)));
  p.u = p.x * p.inv_z;
  p.v = p.y * p.inv_z;
  return p;
}

template <class V>
SGS_SPLAT_INLINE void rotation_matrix(const V (&q)[4], V (&Q)[9]) {
  const V one = V(1.0f), two = V(2.0f);
  const V w = q[0], x = q[1], y = q[2], z = q[3];
  Q[0] = neg_mul_add(two, mul_add(y, y, z * z), one);
  Q[1] = two * neg_mul_add(w, z, x * y);
  Q[2] = two * mul_add(w, y, x * z);
  Q[3] = two * mul_add(w, z, x * y);
  Q[4] = neg_mul_add(two, mul_add(x, x, z * z), one);
  Q[5] = two * neg_mul_add(w, x, y * z);
  Q[6] = two * neg_mul_add(w, y, x * z);
  Q[7] = two * mul_add(w, x, y * z);
  Q[8] = neg_mul_add(two, mul_add(x, x, y * y), one);
}

template <class V, class S>
SGS_SPLAT_INLINE Projection<V> project(const View<S>& view, const CameraPoint<V>& p,
                                       const Splat<V>& g) {
  Projection<V> o;
  const S* R = view.R;
  for (int i = 0; i < 3; ++i) o.scale[i] = exp2_of(g.log_scale[i] * V(S(kLog2E)));
  const V norm2 = mul_add(g.rotation[0], g.rotation[0],
                          dot3(g.rotation[1], g.rotation[1], g.rotation[2], g.rotation[2],
                               g.rotation[3], g.rotation[3]));
  o.inv_norm = V(S(1)) / square_root(norm2);
  for (int i = 0; i < 4; ++i) o.q[i] = g.rotation[i] * o.inv_norm;
  rotation_matrix(o.q, o.Q);

  o.uc = minimum(maximum(p.u, V(view.u_min)), V(view.u_max));
  o.vc = minimum(maximum(p.v, V(view.v_min)), V(view.v_max));
  o.j0 = V(view.fx) * p.inv_z;
  o.j1 = V(view.fy) * p.inv_z;
  for (int k = 0; k < 3; ++k) {
    o.U[k] = o.j0 * neg_mul_add(o.uc, V(R[6 + k]), V(R[k]));
    o.U[3 + k] = o.j1 * neg_mul_add(o.vc, V(R[6 + k]), V(R[3 + k]));
  }
  for (int r = 0; r < 2; ++r) {
    for (int k = 0; k < 3; ++k) {
      o.M[3 * r + k] = o.scale[k] * dot3(o.U[3 * r], o.Q[k], o.U[3 * r + 1], o.Q[3 + k],
                                         o.U[3 * r + 2], o.Q[6 + k]);
    }
  }
  const V xx = dot3(o.M[0], o.M[0], o.M[1], o.M[1], o.M[2], o.M[2]);
  const V yy = dot3(o.M[3], o.M[3], o.M[4], o.M[4], o.M[5], o.M[5]);
  o.cov_xy = dot3(o.M[0], o.M[3], o.M[1], o.M[4], o.M[2], o.M[5]);
  const V low_pass = V(S(kLowPass_px2));
  o.cov_xx = xx + low_pass;
  o.cov_yy = yy + low_pass;
  // Lagrange's identity: |m0|^2 |m1|^2 - (m0 m1)^2 = |m0 x m1|^2, without the cancellation that
  // loses thin Gaussians in single precision.
  const V c0 = neg_mul_add(o.M[2], o.M[4], o.M[1] * o.M[5]);
  const V c1 = neg_mul_add(o.M[0], o.M[5], o.M[2] * o.M[3]);
  const V c2 = neg_mul_add(o.M[1], o.M[3], o.M[0] * o.M[4]);
  const V det = mul_add(low_pass, xx + o.cov_yy, dot3(c0, c0, c1, c1, c2, c2));
  const V inv_det = V(S(1)) / det;
  o.conic_xx = o.cov_yy * inv_det;
  o.conic_xy = V(S(0)) - o.cov_xy * inv_det;
  o.conic_yy = o.cov_xx * inv_det;

  const V limited = minimum(maximum(g.opacity_logit, V(S(-60))), V(S(60)));
  o.opacity = V(S(1)) / (V(S(1)) + exp2_of(limited * V(S(-kLog2E))));
  o.log2_opacity = log2_of(o.opacity);
  o.mean_x = mul_add(V(view.fx), p.u, V(view.cx));
  o.mean_y = mul_add(V(view.fy), p.v, V(view.cy));
  return o;
}

// d loss / d parameters and camera twist from the sums over pixels.
template <class V, class S>
SGS_SPLAT_INLINE SplatGradient<V> splat_backward(const View<S>& view, const CameraPoint<V>& p,
                                                 const Projection<V>& o,
                                                 const ImageGradient<V>& in) {
  SplatGradient<V> g;
  const S* R = view.R;
  const V zero(S(0)), one(S(1)), two(S(2)), minus_half(S(-0.5));
  const V a = o.conic_xx, b = o.conic_xy, d = o.conic_yy;

  // alpha = o exp(-d^T conic d / 2): gradients of the projected mean and of the conic.
  const V g_mean_x = mul_add(a, in.hx, b * in.hy);
  const V g_mean_y = mul_add(b, in.hx, d * in.hy);
  const V G00 = minus_half * in.hxx, G01 = minus_half * in.hxy, G11 = minus_half * in.hyy;
  // d conic^-1: dL/dcov = -conic G conic.
  const V h00 = mul_add(a, G00, b * G01), h01 = mul_add(a, G01, b * G11);
  const V h10 = mul_add(b, G00, d * G01), h11 = mul_add(b, G01, d * G11);
  const V S00 = zero - mul_add(h00, a, h01 * b);
  const V S01 = zero - mul_add(h00, b, h01 * d);
  const V S11 = zero - mul_add(h10, b, h11 * d);

  // cov = M M^T: dL/dM = 2 S M, then M = P diag(scale).
  V D[6];
  for (int k = 0; k < 3; ++k) {
    D[k] = two * mul_add(S00, o.M[k], S01 * o.M[3 + k]);
    D[3 + k] = two * mul_add(S01, o.M[k], S11 * o.M[3 + k]);
    g.log_scale[k] = mul_add(D[k], o.M[k], D[3 + k] * o.M[3 + k]);
    D[k] = D[k] * o.scale[k];
    D[3 + k] = D[3 + k] * o.scale[k];
  }
  // P = U Q: dL/dQ = U^T D, dL/dU = D Q^T.
  V B[9], W[6];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) B[3 * i + k] = mul_add(o.U[i], D[k], o.U[3 + i] * D[3 + k]);
    for (int r = 0; r < 2; ++r) {
      W[3 * r + i] =
          dot3(D[3 * r], o.Q[3 * i], D[3 * r + 1], o.Q[3 * i + 1], D[3 * r + 2], o.Q[3 * i + 2]);
    }
  }
  // U = J R: dL/dJ = dL/dU R^T, J = [j0 0 -j0 uc; 0 j1 -j1 vc].
  V dJ[6];
  for (int r = 0; r < 2; ++r) {
    for (int i = 0; i < 3; ++i) {
      dJ[3 * r + i] =
          dot3(W[3 * r], V(R[3 * i]), W[3 * r + 1], V(R[3 * i + 1]), W[3 * r + 2], V(R[3 * i + 2]));
    }
  }
  const V in_x = one_where_equal(p.u, o.uc), in_y = one_where_equal(p.v, o.vc);
  const V s0 = o.j0 * p.inv_z, s1 = o.j1 * p.inv_z;
  const V gx = neg_mul_add(dJ[2] * s0, in_x, g_mean_x * o.j0);
  const V gy = neg_mul_add(dJ[5] * s1, in_y, g_mean_y * o.j1);
  V gz = in.z - mul_add(g_mean_x * o.j0, p.u, g_mean_y * o.j1 * p.v);
  gz = gz - mul_add(dJ[0], s0, dJ[4] * s1);
  gz = mul_add(dJ[2] * s0, o.uc * (one + in_x), gz);
  gz = mul_add(dJ[5] * s1, o.vc * (one + in_y), gz);

  for (int k = 0; k < 3; ++k) {
    g.mean[k] = dot3(V(R[k]), gx, V(R[3 + k]), gy, V(R[6 + k]), gz);
  }
  g.opacity_logit = in.h * (one - o.opacity);

  const V w = o.q[0], x = o.q[1], y = o.q[2], z = o.q[3];
  const V t12 = B[7] - B[5], t20 = B[2] - B[6], t01 = B[3] - B[1];
  const V u01 = B[1] + B[3], u02 = B[2] + B[6], u12 = B[5] + B[7];
  V q[4];
  q[0] = two * dot3(x, t12, y, t20, z, t01);
  q[1] = two * (dot3(y, u01, z, u02, w, t12) - two * x * (B[4] + B[8]));
  q[2] = two * (dot3(x, u01, z, u12, w, t20) - two * y * (B[0] + B[8]));
  q[3] = two * (dot3(x, u02, y, u12, w, t01) - two * z * (B[0] + B[4]));
  // Through the normalisation of the raw quaternion.
  const V radial = mul_add(q[0], w, dot3(q[1], x, q[2], y, q[3], z));
  for (int k = 0; k < 4; ++k) g.rotation[k] = neg_mul_add(radial, o.q[k], q[k]) * o.inv_norm;

  // Camera: p' = p - phi x p - rho and R' = (I - [phi]x) R, so that dL/drho = -g,
  // dL/dphi = -(p x g) - axial part of K = dL/dR R^T = J^T dJ.
  const V J02 = zero - o.j0 * o.uc, J12 = zero - o.j1 * o.vc;
  const V K12 = o.j1 * dJ[5], K21 = mul_add(J02, dJ[1], J12 * dJ[4]);
  const V K02 = o.j0 * dJ[2], K20 = mul_add(J02, dJ[0], J12 * dJ[3]);
  const V K01 = o.j0 * dJ[1], K10 = o.j1 * dJ[3];
  g.twist[0] = mul_add(p.z, gy, neg_mul_add(p.y, gz, K12 - K21));
  g.twist[1] = mul_add(p.x, gz, neg_mul_add(p.z, gx, K20 - K02));
  g.twist[2] = mul_add(p.y, gx, neg_mul_add(p.x, gy, K01 - K10));
  g.twist[3] = zero - gx;
  g.twist[4] = zero - gy;
  g.twist[5] = zero - gz;
  return g;
}
