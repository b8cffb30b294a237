/// The live parameters of `Parachute`, SI units. `default()` has the declared values.
#[derive(
    Clone,
    Debug,
    PartialEq,
    ::mbd_runtime::serde::Serialize,
    ::mbd_runtime::serde::Deserialize
)]
#[serde(crate = "::mbd_runtime::serde", deny_unknown_fields)]
pub struct ParachuteParams<T = f64> {
    /// Stiffness of the riser. \[kN/m\], 10 ..= 200 kN/m; the field is in SI units
    pub riser_k: T,
    /// Capsule mass. \[kg\], 600 ..= 900 kg
    pub m_cap: T,
    /// Drag coefficient times reference area. \[m^2\], 60 ..= 100 m^2
    pub cd_s: T,
}
impl<T: ::mbd_runtime::Real> ::core::default::Default for ParachuteParams<T> {
    fn default() -> Self {
        ParachuteParams {
            riser_k: T::from_f64(60000.0),
            m_cap: T::from_f64(761.0),
            cd_s: T::from_f64(82.0),
        }
    }
}
impl<T: ::mbd_runtime::Real> ParachuteParams<T> {
    /// The values in declaration order.
    #[must_use]
    pub fn to_array(&self) -> [T; 3] {
        [self.riser_k, self.m_cap, self.cd_s]
    }
    /// Parameters from values in declaration order.
    #[must_use]
    pub fn from_array(values: [T; 3]) -> Self {
        let [riser_k, m_cap, cd_s] = values;
        ParachuteParams {
            riser_k,
            m_cap,
            cd_s,
        }
    }
}
impl<T: ::mbd_runtime::Real> ::mbd_runtime::Params<T> for ParachuteParams<T> {
    const MODEL: ::core::option::Option<&'static str> = ::core::option::Option::Some(
        "Parachute",
    );
    fn values(&self) -> impl ::core::convert::AsRef<[T]> {
        self.to_array()
    }
}
/// The state of `Parachute`: items in declaration order, bodies before points.
///
/// `q` per body x y z qw qx qy qz, per point x y z; `v` per body vx vy vz (world axes, centre of mass) wx wy wz, per point vx vy vz. Bodies and points have functions of their names.
#[derive(Clone, Debug, PartialEq)]
pub struct ParachuteState<T = f64> {
    /// Coordinates \[m, 1\].
    pub q: ::mbd_runtime::nalgebra::SVector<T, 14>,
    /// Speeds \[m/s, rad/s\].
    pub v: ::mbd_runtime::nalgebra::SVector<T, 12>,
    /// Positions of the `rate` nodes \[m\].
    pub z: ::mbd_runtime::nalgebra::SVector<T, 3>,
}
impl<T: ::mbd_runtime::Real> ParachuteState<T> {
    /// Everything at the world origin, at rest, along the axes of the world.
    #[must_use]
    pub fn at_origin() -> Self {
        let mut state = ParachuteState {
            q: ::mbd_runtime::nalgebra::SVector::zeros(),
            v: ::mbd_runtime::nalgebra::SVector::zeros(),
            z: ::mbd_runtime::nalgebra::SVector::zeros(),
        };
        let [q] = &mut state.q.data.0;
        q[3] = T::one();
        q[10] = T::one();
        state
    }
    /// The state from the list q, v, z; `None` if it has another length.
    #[must_use]
    pub fn from_slice(x: &[T]) -> ::core::option::Option<Self> {
        let (q, v, z) = ::mbd_runtime::__private::split::<T, 14, 12, 3>(x)?;
        let _ = z;
        ::core::option::Option::Some(ParachuteState {
            q: (*q).into(),
            v: (*v).into(),
            z: (*z).into(),
        })
    }
    /// The state as the list q, v, z.
    #[must_use]
    pub fn to_vec(&self) -> ::std::vec::Vec<T> {
        let mut out = ::std::vec::Vec::with_capacity(29);
        out.extend_from_slice(self.q.as_slice());
        out.extend_from_slice(self.v.as_slice());
        out.extend_from_slice(self.z.as_slice());
        out
    }
    /// Where `canopy` is and how it moves.
    #[must_use]
    pub fn canopy(&self) -> ::mbd_runtime::BodyState<T> {
        ::mbd_runtime::__private::read(self.q.as_slice(), self.v.as_slice(), [0, 0])
    }
    /// Puts `canopy` somewhere.
    pub fn set_canopy(&mut self, to: ::mbd_runtime::BodyState<T>) {
        ::mbd_runtime::__private::write(
            to,
            self.q.as_mut_slice(),
            self.v.as_mut_slice(),
            [0, 0],
        );
    }
    /// Where `capsule` is and how it moves.
    #[must_use]
    pub fn capsule(&self) -> ::mbd_runtime::BodyState<T> {
        ::mbd_runtime::__private::read(self.q.as_slice(), self.v.as_slice(), [7, 6])
    }
    /// Puts `capsule` somewhere.
    pub fn set_capsule(&mut self, to: ::mbd_runtime::BodyState<T>) {
        ::mbd_runtime::__private::write(
            to,
            self.q.as_mut_slice(),
            self.v.as_mut_slice(),
            [7, 6],
        );
    }
}
/// The outputs of `Parachute`.
#[derive(Clone, Debug, PartialEq)]
pub struct ParachuteOutputs<T = f64> {
    /// Tension of the riser. \[N\]
    pub riser_force: T,
    /// \[rad\]
    pub tilt: T,
}
impl<T> ParachuteOutputs<T> {
    /// Name and unit of every column, in the order of `Quantity::Outputs`.
    pub const COLUMNS: &'static [(&'static str, &'static str)] = &[
        ("riser_force", "N"),
        ("tilt", "rad"),
    ];
    /// Outputs from their columns.
    #[must_use]
    pub fn from_array(columns: [T; 2]) -> Self {
        let [c0, c1] = columns;
        ParachuteOutputs {
            riser_force: c0,
            tilt: c1,
        }
    }
}
/// What the caller of `Parachute` supplies, SI units. `default()` has the declared values; external loads and external gravity are zero.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    ::mbd_runtime::serde::Serialize,
    ::mbd_runtime::serde::Deserialize
)]
#[serde(crate = "::mbd_runtime::serde", deny_unknown_fields)]
pub struct ParachuteInputs<T = f64> {
    /// Wind, world axes. \[m/s\]
    pub wind: [T; 3],
    /// Force \[N\] and couple \[N m\], world axes.
    pub thruster: ::mbd_runtime::Wrench<T>,
}
/// What a controller of `Parachute` sees.
#[allow(dead_code, reason = "for controllers that are functions")]
pub type ParachuteSample<'a, T = f64> = ::mbd_runtime::Sample<'a, ParachuteInputs<T>, T>;
impl<T: ::mbd_runtime::Real> ::core::default::Default for ParachuteInputs<T> {
    fn default() -> Self {
        Self::from_array([
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
            T::from_f64(0.0),
        ])
    }
}
impl<T: ::mbd_runtime::Real> ParachuteInputs<T> {
    /// The numbers in the order of `Layout::inputs`.
    #[must_use]
    pub fn to_array(&self) -> [T; 9] {
        let ParachuteInputs {
            wind: [n0,
            n1,
            n2,
            ],
            thruster: ::mbd_runtime::Wrench { force: [n3, n4, n5], couple: [n6, n7, n8] },
        } = *self;
        [n0, n1, n2, n3, n4, n5, n6, n7, n8]
    }
    /// Inputs from their numbers.
    #[must_use]
    pub fn from_array(numbers: [T; 9]) -> Self {
        let [n0, n1, n2, n3, n4, n5, n6, n7, n8] = numbers;
        ParachuteInputs {
            wind: [n0, n1, n2],
            thruster: ::mbd_runtime::Wrench {
                force: [n3, n4, n5],
                couple: [n6, n7, n8],
            },
        }
    }
}
impl<T: ::mbd_runtime::Real> ::mbd_runtime::Inputs<T> for ParachuteInputs<T> {
    const MODEL: ::core::option::Option<(&'static str, [usize; 2])> = ::core::option::Option::Some((
        "Parachute",
        [29, 9],
    ));
    type State = ParachuteState<T>;
    type Coordinates = ();
    type Outputs = ParachuteOutputs<T>;
    fn from_numbers(numbers: &[T]) -> ::core::option::Option<Self> {
        ::mbd_runtime::__private::fixed(numbers).copied().map(Self::from_array)
    }
    fn numbers(&self) -> impl ::core::convert::AsRef<[T]> {
        self.to_array()
    }
    fn state(numbers: &[T]) -> ParachuteState<T> {
        ParachuteState::from_slice(numbers).unwrap_or_else(ParachuteState::at_origin)
    }
    fn coordinates(numbers: &[T]) -> Self::Coordinates {
        let _ = numbers;
    }
    fn outputs(columns: &[T]) -> Self::Outputs {
        ParachuteOutputs::from_array(::mbd_runtime::__private::leading(columns))
    }
}
/// Capsule under a disk-gap-band canopy: one riser, three bridle legs, massless confluence point.
///
/// Generated by `model!` from a declaration of 2 bodies, 1 point, 4 lines, 2 loads: do not edit. State 29 = 14 coordinates + 12 speeds + 3 node states.
///
/// | function | numbers | operations |
/// |---|---|---|
/// | [`anchor_states`](Self::anchor_states) | 27 of 27 | 187 |
/// | [`derivative`](Self::derivative) | 29 of 29 | 593 |
/// | [`rates`](Self::rates) | 64 of 64 | 790 |
/// | [`balance`](Self::balance) | 3 of 3 | 343 |
/// | [`guards`](Self::guards) | 9 of 9 | 299 |
/// | [`outputs`](Self::outputs) | 2 of 2 | 100 |
/// | [`energy`](Self::energy) | 6 of 6 | 490 |
/// | [`mass_matrix`](Self::mass_matrix) | 16 of 144 | 0 |
/// | [`bias_force`](Self::bias_force) | 12 of 12 | 58 |
/// | [`forces`](Self::forces) | 12 of 12 | 460 |
#[derive(Clone, Debug)]
pub struct Parachute<T = f64> {
    params: ParachuteParams<T>,
    values: [T; 3],
    derived: [T; 2],
    lines: ::mbd_runtime::__private::Lines<T>,
}
#[doc(hidden)]
#[allow(
    unused_variables,
    unused_mut,
    unused_imports,
    unused_doc_comments,
    dead_code,
    non_snake_case,
    clippy::all,
    clippy::pedantic,
    reason = "generated by `model!`"
)]
const _: () = {
    impl<T: ::mbd_runtime::Scalar> Parachute<T> {
        /// A model with these parameters.
        ///
        /// # Errors
        /// The first parameter that is not finite, outside its range, or gives a body or line numbers that none has.
        pub fn new(
            params: ParachuteParams<T>,
        ) -> ::core::result::Result<Self, ::mbd_runtime::ParamError> {
            let values = params.to_array();
            let lines = <T as ::mbd_runtime::Scalar>::prepare(
                &declared().scene,
                &values,
            )?;
            ::core::result::Result::Ok(Self::assembled(params, values, lines))
        }
    }
    impl<T: ::mbd_runtime::Real> Parachute<T> {
        fn assembled(
            params: ParachuteParams<T>,
            values: [T; 3],
            lines: ::mbd_runtime::__private::Lines<T>,
        ) -> Self {
            let mut terms = [T::zero(); 2];
            derived(&values, &mut terms);
            Parachute {
                params,
                values,
                derived: terms,
                lines,
            }
        }
        /// A model with parameters that nobody has checked: for dual numbers and lanes.
        #[must_use]
        #[inline]
        pub fn unchecked(params: ParachuteParams<T>) -> Self {
            let values = params.to_array();
            let lines = ::mbd_runtime::__private::unchecked(&declared().scene, &values);
            Self::assembled(params, values, lines)
        }
        /// The parameters; new ones make a new model.
        #[must_use]
        pub fn parameters(&self) -> &ParachuteParams<T> {
            &self.params
        }
        /// The declaration as data.
        #[must_use]
        pub fn scene() -> ::mbd_runtime::scene::Scene {
            declared().copy()
        }
        /// The equations in the user's names, what was left out, and what everything costs.
        #[must_use]
        pub fn explain() -> &'static str {
            "Parachute\n\nState x = [q | v | z]: 14 + 12 + 3; angular velocities in body axes.\nM v\u{307} + h = f,  q\u{307} = N(q) v,  one block of M a body.\nGravity: −μ d/|d|³, μ = 42828000000000 m³/s², centre at [0, 0, -3404590] m.\n\nBody canopy: m = 16 kg, I = [xx 60, yy 60, zz 90] kg m² about the centre of mass.\nBody capsule: m = m_cap kg, I = [xx 300, yy 310, zz 420, xy -1.5, yz 2] kg m² about the centre of mass.\nPoint confluence: node, rate: its velocity w solves Σ T u + W = 0 with T = K s + C ṡ; ż = w.\nLine riser from canopy.riser_end to confluence: T = max(0, K s + C ṡ) for s > 0, else 0; K = riser_k N/m, C = 600 N s/m, L0 = 10 m.\nLine leg[0] from capsule.bridle[0] to confluence: T = max(0, K s + C ṡ) for s > 0, else 0; K = 47000 N/m, C = 470 N s/m, L0 = L_LEG m.\nLine leg[1] from capsule.bridle[1] to confluence: T = max(0, K s + C ṡ) for s > 0, else 0; K = 47000 N/m, C = 470 N s/m, L0 = L_LEG m.\nLine leg[2] from capsule.bridle[2] to confluence: T = max(0, K s + C ṡ) for s > 0, else 0; K = 47000 N/m, C = 470 N s/m, L0 = L_LEG m.\nLoad drag at canopy.cp: force -0.007 * cd_s * norm(canopy.cp.velocity - wind) * (canopy.cp.velocity - wind) N.\nLoad thruster at capsule.com: from the caller.\nOutput riser_force = riser.tension [N].\nOutput tilt = angle(capsule.com.z, world.z) [rad].\nEvent slack: riser.tension crosses 0.\n\nLeft out\n  No joint with rows: no constraint, no multiplier, no linear system for accelerations.\n  Body canopy: principal axes, no products of inertia.\n\nOperations\n  once per set of params: 2 operations (0 additions, 1 multiplications, 1 divisions, 0 roots, 0 trigonometric, 0 selections)\n  anchor_states: 187 operations (99 additions, 88 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections)\n  derivative: 593 operations (255 additions, 293 multiplications, 6 divisions, 7 roots, 0 trigonometric, 32 selections)\n  rates: 790 operations (335 additions, 394 multiplications, 7 divisions, 7 roots, 0 trigonometric, 47 selections)\n  balance: 343 operations (159 additions, 144 multiplications, 4 divisions, 4 roots, 0 trigonometric, 32 selections)\n  guards: 299 operations (147 additions, 132 multiplications, 4 divisions, 4 roots, 0 trigonometric, 12 selections)\n  outputs: 100 operations (45 additions, 42 multiplications, 1 divisions, 2 roots, 1 trigonometric, 9 selections)\n  energy: 490 operations (210 additions, 225 multiplications, 8 divisions, 7 roots, 0 trigonometric, 40 selections)\n  mass_matrix: 0 operations (0 additions, 0 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections)\n  bias_force: 58 operations (13 additions, 41 multiplications, 2 divisions, 2 roots, 0 trigonometric, 0 selections)\n  forces: 460 operations (209 additions, 210 multiplications, 4 divisions, 5 roots, 0 trigonometric, 32 selections)\n\nderivative: 593 operations as declared, 593 with every param a const, 593 with every const a param.\n"
        }
    }
    /// The declaration and where everything lives, unpacked once. Which rows repeat others and in which order the system is solved was found when this was generated.
    fn declared() -> &'static ::mbd_runtime::__private::Declared {
        static DECLARED: ::std::sync::OnceLock<::mbd_runtime::__private::Declared> = ::std::sync::OnceLock::new();
        DECLARED
            .get_or_init(|| ::mbd_runtime::__private::Declared::unpacked(
                "9 Parachute 94 Capsule under a disk-gap-band canopy: one riser, three bridle legs, massless confluence point. 0 0 0 2 0 42828000000000.0 0 0.0 0 0.0 0 -3404590.0 2 5 L_LEG 0  0 2.1 1 m 1.0 0 2 0 0 3 RHO 0  0 0.014 6 kg/m^3 1.0 2 -6 0 0 3 7 riser_k 23 Stiffness of the riser. 60000.0 1 10000.0 200000.0 4 kN/m 1000.0 2 0 -4 0 5 m_cap 13 Capsule mass. 761.0 1 600.0 900.0 2 kg 1.0 2 0 0 0 4 cd_s 38 Drag coefficient times reference area. 82.0 1 60.0 100.0 3 m^2 1.0 0 4 0 0 1 4 wind 17 Wind, world axes. 3 3 m/s 1.0 0 2 -2 0 0.0 0.0 0.0 0 0 0 1 5 world 0 0.0 0 0.0 0 0.0 0 2 6 canopy 0  0 16.0 0 60.0 0 60.0 0 90.0 0 0.0 0 0.0 0 0.0 3 3 com 0 0.0 0 0.0 0 0.0 0 9 riser_end 0 0.0 0 0.0 0 -9.5 0 2 cp 0 0.0 0 0.0 0 1.57 0 7 capsule 0  2 1 0 300.0 0 310.0 0 420.0 0 -1.5 0 0.0 0 2.0 4 3 com 0 0.0 0 0.0 0 0.0 0 9 bridle[0] 0 0.55 0 0.0 0 1.23 0 9 bridle[1] 0 -0.2749999999999999 0 0.47631397208144133 0 1.23 0 9 bridle[2] 0 -0.27500000000000024 0 -0.47631397208144116 0 1.23 0 1 10 confluence 0  1 2 2 11 canopy_free 0  0 0 0 1 0 0 0 0 12 capsule_free 0  0 0 0 1 1 0 0 0 4 5 riser 0  0 1 0 1 2 0 0 10.0 2 0 0 600.0 6 leg[0] 0  0 1 1 1 2 0 1 0 0 47000.0 0 470.0 6 leg[1] 0  0 1 1 2 2 0 1 0 0 47000.0 0 470.0 6 leg[2] 0  0 1 1 3 2 0 1 0 0 47000.0 0 470.0 2 4 drag 0  1 0 2 0 27 2 2 27 2 2 27 2 2 0 -0.007 2 2 27 6 1 27 1 2 7 1 0 2 3 0 27 1 2 7 1 0 2 3 0 8 thruster 0  1 1 0 2 2 11 riser_force 21 Tension of the riser. 13 0 1 1 N 1.0 2 2 -4 0 4 tilt 0  27 16 2 8 1 1 0 2 8 0 0 2 1 3 rad 1.0 0 0 0 0 1 5 slack 0  13 0 0 0 0 0 0 0 0 0 0 0 0 0 ",
                "0 0 0 0 1 0 0 0 0 0 18446744073709551615 ",
            ))
    }
    impl<T: ::mbd_runtime::Real> Parachute<T> {
        /// State derivative: `q̇ = N(q) v`, `v̇ = M⁻¹ (f − h)`, `ż = w`.
        ///
        /// 29 = \[14 q̇ | 12 v̇ | 3 ż\]; SI units.
        /// 593 operations (255 additions, 293 multiplications, 6 divisions, 7 roots, 0 trigonometric, 32 selections).
        #[must_use]
        #[inline]
        pub fn derivative(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
            inputs: &ParachuteInputs<T>,
        ) -> ParachuteState<T> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let inputs = &inputs.to_array();
            let mut values = [T::zero(); 29];
            let out = &mut values;
            derivative(q, v, z, nodes, hold, inputs, &self.values, &self.derived, out);
            let (q, v, z): ([T; 14], [T; 12], [T; 3]) = ::mbd_runtime::__private::parts(
                &values,
            );
            ParachuteState {
                q: q.into(),
                v: v.into(),
                z: z.into(),
            }
        }
        /// The declared outputs.
        ///
        /// 2 columns, each in its unit.
        /// 100 operations (45 additions, 42 multiplications, 1 divisions, 2 roots, 1 trigonometric, 9 selections).
        #[must_use]
        #[inline]
        pub fn outputs(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
        ) -> ParachuteOutputs<T> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let mut values = [T::zero(); 2];
            let out = &mut values;
            outputs(q, v, z, nodes, hold, &self.values, out);
            ParachuteOutputs::from_array(values)
        }
        /// Energy and power: `½ v·M v`, gravity, `Σ ½ K s₊²`, power of the loads, of the dampers, of prescribed motions.
        ///
        /// 6 \[J, J, J, W, W, W\].
        /// 490 operations (210 additions, 225 multiplications, 8 divisions, 7 roots, 0 trigonometric, 40 selections).
        #[must_use]
        #[inline]
        pub fn energy(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
            inputs: &ParachuteInputs<T>,
        ) -> ::mbd_runtime::Energy<T> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let inputs = &inputs.to_array();
            let mut values = [T::zero(); 6];
            let out = &mut values;
            energy(q, v, z, nodes, hold, inputs, &self.values, &self.derived, out);
            let [kinetic, gravitational, elastic, load_power, damper_power, drive_power,
            ] = values;
            ::mbd_runtime::Energy {
                kinetic,
                gravitational,
                elastic,
                load_power,
                damper_power,
                drive_power,
            }
        }
        /// Mass matrix `M` in `M v̇ + h = f`.
        ///
        /// 12×12 \[kg, kg m²\], row by row, structural non-zeros only.
        /// 0 operations (0 additions, 0 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections).
        ///
        /// Only structural non-zeros are written: `out` starts at zero.
        #[inline]
        pub fn mass_matrix(
            &self,
            out: &mut ::mbd_runtime::nalgebra::SMatrix<T, 12, 12>,
        ) {
            if let ::core::option::Option::Some(out) = ::mbd_runtime::__private::fixed_mut::<
                T,
                144,
            >(out.as_mut_slice()) {
                mass_matrix(&self.values, out);
            }
        }
        /// Bias force `h` in `M v̇ + h = f`: velocity terms and gravity.
        ///
        /// 12 \[N, N m\].
        /// 58 operations (13 additions, 41 multiplications, 2 divisions, 2 roots, 0 trigonometric, 0 selections).
        #[must_use]
        #[inline]
        pub fn bias_force(
            &self,
            state: &ParachuteState<T>,
        ) -> ::mbd_runtime::nalgebra::SVector<T, 12> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let mut values = [T::zero(); 12];
            let out = &mut values;
            bias_force(q, v, &self.values, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// Applied forces `f` in `M v̇ + h = f`: lines and loads.
        ///
        /// 12 \[N, N m\], about the centres of mass.
        /// 460 operations (209 additions, 210 multiplications, 4 divisions, 5 roots, 0 trigonometric, 32 selections).
        #[must_use]
        #[inline]
        pub fn forces(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
            inputs: &ParachuteInputs<T>,
        ) -> ::mbd_runtime::nalgebra::SVector<T, 12> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let inputs = &inputs.to_array();
            let mut values = [T::zero(); 12];
            let out = &mut values;
            forces(q, v, z, nodes, hold, inputs, &self.values, &self.derived, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// Anchors of the node lines and loads of the nodes: `p`, `v` of each anchor, then `W` of each node.
        ///
        /// 4 anchors × 6 \[m, m/s\], 1 nodes × 3 \[N\]; world axes.
        /// 187 operations (99 additions, 88 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections).
        #[doc(hidden)]
        #[must_use]
        #[inline]
        pub fn anchor_states(
            &self,
            state: &ParachuteState<T>,
        ) -> ::mbd_runtime::nalgebra::SVector<T, 27> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let mut values = [T::zero(); 27];
            let out = &mut values;
            anchor_states(q, v, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// State derivative with the velocities of the nodes found along with it, `D w = Σ (K s + C u·v) u` over the lines that carry.
        ///
        /// 29 ẋ, then 4 anchors × 6 \[m, m/s\], 1 nodes × 3 loads \[N\], per node `det D − 1e-5 (tr D)³` \[N³ s³/m³\], the largest term of a pull and the largest pull \[N\], whether its lines do what was held of them (> 0), per line stretch \[m\].
        /// 790 operations (335 additions, 394 multiplications, 7 divisions, 7 roots, 0 trigonometric, 47 selections).
        #[doc(hidden)]
        #[must_use]
        #[inline]
        pub fn rates(
            &self,
            state: &ParachuteState<T>,
            hold: &[T; 4],
            inputs: &ParachuteInputs<T>,
        ) -> ::mbd_runtime::nalgebra::SVector<T, 64> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let inputs = &inputs.to_array();
            let mut values = [T::zero(); 64];
            let out = &mut values;
            rates(q, v, z, hold, inputs, &self.values, &self.derived, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// Balance of the nodes: `r = Σ T u + W`, the forces on each node.
        ///
        /// 3 \[N\], world axes; zero where the nodes are in equilibrium.
        /// 343 operations (159 additions, 144 multiplications, 4 divisions, 4 roots, 0 trigonometric, 32 selections).
        #[doc(hidden)]
        #[must_use]
        #[inline]
        pub fn balance(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
        ) -> ::mbd_runtime::nalgebra::SVector<T, 3> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let mut values = [T::zero(); 3];
            let out = &mut values;
            balance(q, v, z, nodes, hold, &self.values, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// Guards: stretch `s = d − L0` and pull `K s + C ṡ` of each line, depth and pull of each stop, then the declared events.
        ///
        /// 4 lines × 2 \[m, N\], 0 stops × 2 \[m, N or rad, N m\], 1 events.
        /// 299 operations (147 additions, 132 multiplications, 4 divisions, 4 roots, 0 trigonometric, 12 selections).
        #[doc(hidden)]
        #[must_use]
        #[inline]
        pub fn guards(
            &self,
            state: &ParachuteState<T>,
            nodes: &[T; 3],
            hold: &[T; 4],
        ) -> ::mbd_runtime::nalgebra::SVector<T, 9> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let [z] = &state.z.data.0;
            let mut values = [T::zero(); 9];
            let out = &mut values;
            guards(q, v, z, nodes, hold, &self.values, out);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
        /// Rates of the coordinates: `q̇ = N(q) v`. q̇ is not v: a quaternion has four rates, an angular velocity three.
        #[must_use]
        #[inline]
        pub fn kinematics(
            &self,
            state: &ParachuteState<T>,
        ) -> ::mbd_runtime::nalgebra::SVector<T, 14> {
            let [q] = &state.q.data.0;
            let [v] = &state.v.data.0;
            let mut values = [T::zero(); 14];
            kinematics(q, v, &mut values);
            ::mbd_runtime::nalgebra::SVector::from(values)
        }
    }
    impl<T: ::mbd_runtime::Real> Parachute<T> {
        /// Number of coordinates.
        pub const NQ: usize = 14;
        /// Number of speeds.
        pub const NV: usize = 12;
        /// Number of node states.
        pub const NZ: usize = 3;
        /// Number of constraint rows.
        pub const NC: usize = 0;
        /// Number of live parameters.
        pub const NP: usize = 3;
        /// Changes when the declaration changes.
        pub const DECL_HASH: u64 = 9917640440875698575;
        /// Name and unit of every coordinate.
        pub const COORDS: &'static [::mbd_runtime::CoordInfo] = &::mbd_runtime::__private::named([
            ("canopy.x", "m"),
            ("canopy.y", "m"),
            ("canopy.z", "m"),
            ("canopy.qw", ""),
            ("canopy.qx", ""),
            ("canopy.qy", ""),
            ("canopy.qz", ""),
            ("capsule.x", "m"),
            ("capsule.y", "m"),
            ("capsule.z", "m"),
            ("capsule.qw", ""),
            ("capsule.qx", ""),
            ("capsule.qy", ""),
            ("capsule.qz", ""),
        ]);
        /// Name and unit of every speed.
        pub const SPEEDS: &'static [::mbd_runtime::CoordInfo] = &::mbd_runtime::__private::named([
            ("canopy.vx", "m/s"),
            ("canopy.vy", "m/s"),
            ("canopy.vz", "m/s"),
            ("canopy.wx", "rad/s"),
            ("canopy.wy", "rad/s"),
            ("canopy.wz", "rad/s"),
            ("capsule.vx", "m/s"),
            ("capsule.vy", "m/s"),
            ("capsule.vz", "m/s"),
            ("capsule.wx", "rad/s"),
            ("capsule.wy", "rad/s"),
            ("capsule.wz", "rad/s"),
        ]);
        /// Row and column of every structural non-zero of `mass_matrix`, row by row; all else is zero in every state.
        pub const MASS_MATRIX_SPARSITY: &'static [(usize, usize)] = &[
            (0, 0),
            (1, 1),
            (2, 2),
            (3, 3),
            (4, 4),
            (5, 5),
            (6, 6),
            (7, 7),
            (8, 8),
            (9, 9),
            (9, 10),
            (10, 9),
            (10, 10),
            (10, 11),
            (11, 10),
            (11, 11),
        ];
        /// Name, unit, default, range and documentation of every live parameter.
        pub const PARAMS: &'static [::mbd_runtime::ParamInfo] = &[
            ::mbd_runtime::ParamInfo {
                name: "riser_k",
                doc: "Stiffness of the riser.",
                unit: "kN/m",
                factor: 1000.0,
                default: 60000.0,
                range: ::core::option::Option::Some([10000.0, 200000.0]),
            },
            ::mbd_runtime::ParamInfo {
                name: "m_cap",
                doc: "Capsule mass.",
                unit: "kg",
                factor: 1.0,
                default: 761.0,
                range: ::core::option::Option::Some([600.0, 900.0]),
            },
            ::mbd_runtime::ParamInfo {
                name: "cd_s",
                doc: "Drag coefficient times reference area.",
                unit: "m^2",
                factor: 1.0,
                default: 82.0,
                range: ::core::option::Option::Some([60.0, 100.0]),
            },
        ];
        /// Operations of every quantity.
        pub const COST: ::mbd_runtime::Costs = ::mbd_runtime::Costs(
            &[
                (
                    "anchor_states",
                    ::mbd_runtime::Cost {
                        adds: 99,
                        muls: 88,
                        divs: 0,
                        sqrts: 0,
                        trigs: 0,
                        selects: 0,
                    },
                ),
                (
                    "derivative",
                    ::mbd_runtime::Cost {
                        adds: 255,
                        muls: 293,
                        divs: 6,
                        sqrts: 7,
                        trigs: 0,
                        selects: 32,
                    },
                ),
                (
                    "rates",
                    ::mbd_runtime::Cost {
                        adds: 335,
                        muls: 394,
                        divs: 7,
                        sqrts: 7,
                        trigs: 0,
                        selects: 47,
                    },
                ),
                (
                    "balance",
                    ::mbd_runtime::Cost {
                        adds: 159,
                        muls: 144,
                        divs: 4,
                        sqrts: 4,
                        trigs: 0,
                        selects: 32,
                    },
                ),
                (
                    "guards",
                    ::mbd_runtime::Cost {
                        adds: 147,
                        muls: 132,
                        divs: 4,
                        sqrts: 4,
                        trigs: 0,
                        selects: 12,
                    },
                ),
                (
                    "outputs",
                    ::mbd_runtime::Cost {
                        adds: 45,
                        muls: 42,
                        divs: 1,
                        sqrts: 2,
                        trigs: 1,
                        selects: 9,
                    },
                ),
                (
                    "energy",
                    ::mbd_runtime::Cost {
                        adds: 210,
                        muls: 225,
                        divs: 8,
                        sqrts: 7,
                        trigs: 0,
                        selects: 40,
                    },
                ),
                (
                    "mass_matrix",
                    ::mbd_runtime::Cost {
                        adds: 0,
                        muls: 0,
                        divs: 0,
                        sqrts: 0,
                        trigs: 0,
                        selects: 0,
                    },
                ),
                (
                    "bias_force",
                    ::mbd_runtime::Cost {
                        adds: 13,
                        muls: 41,
                        divs: 2,
                        sqrts: 2,
                        trigs: 0,
                        selects: 0,
                    },
                ),
                (
                    "forces",
                    ::mbd_runtime::Cost {
                        adds: 209,
                        muls: 210,
                        divs: 4,
                        sqrts: 5,
                        trigs: 0,
                        selects: 32,
                    },
                ),
            ],
        );
    }
    impl<T: ::mbd_runtime::Real> ::mbd_runtime::Equations<T> for Parachute<T> {
        fn with(params: &[T]) -> ::core::option::Option<Self> {
            let params = ::mbd_runtime::__private::fixed(params)?;
            ::core::option::Option::Some(
                Self::unchecked(ParachuteParams::from_array(*params)),
            )
        }
        fn layout() -> &'static ::mbd_runtime::Layout {
            &declared().layout
        }
        fn room(&self) -> usize {
            0
        }
        fn evaluate(
            &self,
            what: ::mbd_runtime::Quantity,
            at: &::mbd_runtime::At<'_, T>,
            work: &mut [T],
            out: &mut [T],
        ) {
            match what {
                ::mbd_runtime::Quantity::AnchorStates => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        anchor_states(q, v, out);
                    }
                }
                ::mbd_runtime::Quantity::Derivative => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(inputs),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed(at.inputs),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        derivative(
                            q,
                            v,
                            z,
                            nodes,
                            hold,
                            inputs,
                            &self.values,
                            &self.derived,
                            out,
                        );
                    }
                }
                ::mbd_runtime::Quantity::Rates => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(inputs),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed(at.inputs),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        rates(q, v, z, hold, inputs, &self.values, &self.derived, out);
                    }
                }
                ::mbd_runtime::Quantity::Balance => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        balance(q, v, z, nodes, hold, &self.values, out);
                    }
                }
                ::mbd_runtime::Quantity::Guards => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        guards(q, v, z, nodes, hold, &self.values, out);
                    }
                }
                ::mbd_runtime::Quantity::Outputs => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        outputs(q, v, z, nodes, hold, &self.values, out);
                    }
                }
                ::mbd_runtime::Quantity::Energy => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(inputs),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed(at.inputs),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        energy(
                            q,
                            v,
                            z,
                            nodes,
                            hold,
                            inputs,
                            &self.values,
                            &self.derived,
                            out,
                        );
                    }
                }
                ::mbd_runtime::Quantity::MassMatrix => {
                    if let (::core::option::Option::Some(out)) = (::mbd_runtime::__private::fixed_mut(
                        out,
                    )) {
                        mass_matrix(&self.values, out);
                    }
                }
                ::mbd_runtime::Quantity::BiasForce => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        bias_force(q, v, &self.values, out);
                    }
                }
                ::mbd_runtime::Quantity::Forces => {
                    if let (
                        ::core::option::Option::Some((q, v, z)),
                        ::core::option::Option::Some(nodes),
                        ::core::option::Option::Some(hold),
                        ::core::option::Option::Some(inputs),
                        ::core::option::Option::Some(out),
                    ) = (
                        ::mbd_runtime::__private::split(at.state),
                        ::mbd_runtime::__private::fixed(at.nodes),
                        ::mbd_runtime::__private::fixed(at.hold),
                        ::mbd_runtime::__private::fixed(at.inputs),
                        ::mbd_runtime::__private::fixed_mut(out),
                    ) {
                        let q: &[T; 14] = q;
                        let v: &[T; 12] = v;
                        let z: &[T; 3] = z;
                        forces(
                            q,
                            v,
                            z,
                            nodes,
                            hold,
                            inputs,
                            &self.values,
                            &self.derived,
                            out,
                        );
                    }
                }
                _ => out.fill(T::from_f64(f64::NAN)),
            }
        }
    }
    impl ::mbd_runtime::InLanes for Parachute {
        type Over<T: ::mbd_runtime::Real> = Parachute<T>;
    }
    impl<T: ::mbd_runtime::Scalar> ::mbd_runtime::Model<T> for Parachute<T> {
        fn share(&self) -> ::std::sync::Arc<dyn ::mbd_runtime::Model<T>> {
            ::std::sync::Arc::new(self.clone())
        }
        fn with_params(
            &self,
            params: &[T],
        ) -> ::core::result::Result<
            ::std::sync::Arc<dyn ::mbd_runtime::Model<T>>,
            ::mbd_runtime::ParamError,
        > {
            let params = ParachuteParams::from_array(
                ::mbd_runtime::__private::counted(params)?,
            );
            ::core::result::Result::Ok(::std::sync::Arc::new(Self::new(params)?))
        }
        fn work(&self) -> ::mbd_runtime::Work<T> {
            ::mbd_runtime::Work::list(0)
        }
        fn scene(&self) -> &::mbd_runtime::scene::Scene {
            &declared().scene
        }
        fn layout(&self) -> &::mbd_runtime::Layout {
            &declared().layout
        }
        fn params(&self) -> &[T] {
            &self.values
        }
        fn lines(&self) -> &[::mbd_runtime::scene::laws::LineNumbers<T>] {
            &self.lines
        }
        fn emits(&self, what: ::mbd_runtime::Quantity) -> bool {
            ::core::matches!(
                what, ::mbd_runtime::Quantity::AnchorStates |
                ::mbd_runtime::Quantity::Derivative | ::mbd_runtime::Quantity::Rates |
                ::mbd_runtime::Quantity::Balance | ::mbd_runtime::Quantity::Guards |
                ::mbd_runtime::Quantity::Outputs | ::mbd_runtime::Quantity::Energy |
                ::mbd_runtime::Quantity::MassMatrix | ::mbd_runtime::Quantity::BiasForce
                | ::mbd_runtime::Quantity::Forces
            ) || declared().layout.len(what) == 0
        }
        fn inner_stages(
            &self,
            step: ::mbd_runtime::StepStages<'_, T>,
            work: &mut ::mbd_runtime::Work<T>,
        ) -> bool {
            ::mbd_runtime::__private::inner_rates::<
                T,
                29,
                64,
                true,
            >(
                step,
                |at, rates| {
                    ::mbd_runtime::Model::evaluate(
                        self,
                        ::mbd_runtime::Quantity::Rates,
                        at,
                        work,
                        rates,
                    )
                },
            )
        }
        fn evaluate(
            &self,
            what: ::mbd_runtime::Quantity,
            at: &::mbd_runtime::At<'_, T>,
            work: &mut ::mbd_runtime::Work<T>,
            out: &mut [T],
        ) {
            ::mbd_runtime::Equations::evaluate(self, what, at, &mut work.numbers, out)
        }
    }
    /// Anchors of the node lines and loads of the nodes: `p`, `v` of each anchor, then `W` of each node.
    /// 4 anchors × 6 [m, m/s], 1 nodes × 3 [N]; world axes.
    /// 187 operations (99 additions, 88 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections).
    #[inline(never)]
    fn anchor_states<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        out: &mut [T; 27],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, _, capsule_vx,
        capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let c_m9_5 = T::from_f64(-9.5);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        let zero = T::from_f64(0.0);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_t = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_2 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_3 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_3, capsule_r12.fmadd(leg_1_t_2, capsule_r11 * leg_1_t));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_3, capsule_r22.fmadd(leg_1_t_2, capsule_r21 * leg_1_t));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_3, capsule_r32.fmadd(leg_1_t_2, capsule_r31 * leg_1_t));
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_t = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_2 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_3 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_3, capsule_r12.fmadd(leg_2_t_2, capsule_r11 * leg_2_t));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_3, capsule_r22.fmadd(leg_2_t_2, capsule_r21 * leg_2_t));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_3, capsule_r32.fmadd(leg_2_t_2, capsule_r31 * leg_2_t));
        *out = [
            riser_p_x,
            riser_p_y,
            riser_p_z,
            riser_v_x,
            riser_v_y,
            riser_v_z,
            leg_0_p_x,
            leg_0_p_y,
            leg_0_p_z,
            leg_0_v_x,
            leg_0_v_y,
            leg_0_v_z,
            leg_1_p_x,
            leg_1_p_y,
            leg_1_p_z,
            leg_1_v_x,
            leg_1_v_y,
            leg_1_v_z,
            leg_2_p_x,
            leg_2_p_y,
            leg_2_p_z,
            leg_2_v_x,
            leg_2_v_y,
            leg_2_v_z,
            zero,
            zero,
            zero,
        ];
    }
    /// State derivative: `q̇ = N(q) v`, `v̇ = M⁻¹ (f − h)`, `ż = w`.
    /// 29 = [14 q̇ | 12 v̇ | 3 ż]; SI units.
    /// 593 operations (255 additions, 293 multiplications, 6 divisions, 7 roots, 0 trigonometric, 32 selections).
    #[inline(never)]
    fn derivative<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        inputs: &[T; 9],
        params: &[T; 3],
        derived: &[T; 2],
        out: &mut [T; 29],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, canopy_wz,
        capsule_vx, capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, leg_0_hold, leg_1_hold, leg_2_hold] = *hold;
        let [wind_x, wind_y, wind_z, thruster_x, thruster_y, thruster_z,
        thruster_couple_x, thruster_couple_y, thruster_couple_z] = *inputs;
        let [riser_k, _, _] = *params;
        let [capsule_inverse_mass, derived_1] = *derived;
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        let c_1_57 = T::from_f64(1.57);
        let minus_half = T::from_f64(-0.5);
        let c_0_0625 = T::from_f64(0.0625);
        let c_5 = T::from_f64(-3404590.0);
        let c_6 = T::from_f64(4.2828e13);
        let c_30 = T::from_f64(30.0);
        let c_m30 = T::from_f64(-30.0);
        let c_7 = T::from_f64(0.016666666666666666);
        let c_8 = T::from_f64(0.011111111111111112);
        let c_300 = T::from_f64(300.0);
        let c_m1_5 = T::from_f64(-1.5);
        let c_310 = T::from_f64(310.0);
        let two = T::from_f64(2.0);
        let c_420 = T::from_f64(420.0);
        let c_9 = T::from_f64(0.003333413982923537);
        let c_11 = T::from_f64(1.6129918040814068e-5);
        let c_12 = T::from_f64(-7.680913352768604e-8);
        let c_13 = T::from_f64(0.003225983608162814);
        let c_14 = T::from_f64(-1.536182670553721e-5);
        let c_15 = T::from_f64(0.002381025532508121);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        let riser_force_x = riser_u_x * riser_tension;
        let riser_force_y = riser_u_y * riser_tension;
        let riser_force_z = riser_u_z * riser_tension;
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t - c_2_1;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t_2 = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t_2, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t_2, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t_2, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        let leg_0_rate = leg_0_u_z
            .fmadd(
                confluence_wz - leg_0_v_z,
                leg_0_u_y
                    .fmadd(
                        confluence_wy - leg_0_v_y,
                        leg_0_u_x * (confluence_wx - leg_0_v_x),
                    ),
            );
        let leg_0_pull = c_470.fmadd(leg_0_rate, c_47000 * leg_0_stretch);
        let leg_0_tension = T::select(
            zero.lt(leg_0_hold),
            leg_0_pull,
            T::select(
                leg_0_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_0_stretch), leg_0_pull.max(zero), zero),
            ),
        );
        let leg_0_force_x = leg_0_u_x * leg_0_tension;
        let leg_0_force_y = leg_0_u_y * leg_0_tension;
        let leg_0_force_z = leg_0_u_z * leg_0_tension;
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t - c_2_1;
        let leg_1_t_2 = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_3 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_4 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_4, capsule_r12.fmadd(leg_1_t_3, capsule_r11 * leg_1_t_2));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_4, capsule_r22.fmadd(leg_1_t_3, capsule_r21 * leg_1_t_2));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_4, capsule_r32.fmadd(leg_1_t_3, capsule_r31 * leg_1_t_2));
        let leg_1_rate = leg_1_u_z
            .fmadd(
                confluence_wz - leg_1_v_z,
                leg_1_u_y
                    .fmadd(
                        confluence_wy - leg_1_v_y,
                        leg_1_u_x * (confluence_wx - leg_1_v_x),
                    ),
            );
        let leg_1_pull = c_470.fmadd(leg_1_rate, c_47000 * leg_1_stretch);
        let leg_1_tension = T::select(
            zero.lt(leg_1_hold),
            leg_1_pull,
            T::select(
                leg_1_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_1_stretch), leg_1_pull.max(zero), zero),
            ),
        );
        let leg_1_force_x = leg_1_u_x * leg_1_tension;
        let leg_1_force_y = leg_1_u_y * leg_1_tension;
        let leg_1_force_z = leg_1_u_z * leg_1_tension;
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t - c_2_1;
        let leg_2_t_2 = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_3 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_4 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_4, capsule_r12.fmadd(leg_2_t_3, capsule_r11 * leg_2_t_2));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_4, capsule_r22.fmadd(leg_2_t_3, capsule_r21 * leg_2_t_2));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_4, capsule_r32.fmadd(leg_2_t_3, capsule_r31 * leg_2_t_2));
        let leg_2_rate = leg_2_u_z
            .fmadd(
                confluence_wz - leg_2_v_z,
                leg_2_u_y
                    .fmadd(
                        confluence_wy - leg_2_v_y,
                        leg_2_u_x * (confluence_wx - leg_2_v_x),
                    ),
            );
        let leg_2_pull = c_470.fmadd(leg_2_rate, c_47000 * leg_2_stretch);
        let leg_2_tension = T::select(
            zero.lt(leg_2_hold),
            leg_2_pull,
            T::select(
                leg_2_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_2_stretch), leg_2_pull.max(zero), zero),
            ),
        );
        let leg_2_force_x = leg_2_u_x * leg_2_tension;
        let leg_2_force_y = leg_2_u_y * leg_2_tension;
        let leg_2_force_z = leg_2_u_z * leg_2_tension;
        /// `drag`: load.
        let drag_scaled_canopy_wy = c_1_57 * canopy_wy;
        let drag_scaled_canopy_wx = c_1_57 * canopy_wx;
        let drag_v_x = canopy_vx
            + canopy_r12
                .fnmadd(drag_scaled_canopy_wx, canopy_r11 * drag_scaled_canopy_wy);
        let drag_v_y = canopy_vy
            + canopy_r22
                .fnmadd(drag_scaled_canopy_wx, canopy_r21 * drag_scaled_canopy_wy);
        let drag_v_z = canopy_vz
            + canopy_r32
                .fnmadd(drag_scaled_canopy_wx, canopy_r31 * drag_scaled_canopy_wy);
        let drag_v_x_minus_wind_x = drag_v_x - wind_x;
        let drag_v_y_minus_wind_y = drag_v_y - wind_y;
        let drag_v_z_minus_wind_z = drag_v_z - wind_z;
        let drag_t = derived_1
            * drag_v_z_minus_wind_z
                .fmadd(
                    drag_v_z_minus_wind_z,
                    drag_v_y_minus_wind_y
                        .fmadd(
                            drag_v_y_minus_wind_y,
                            drag_v_x_minus_wind_x * drag_v_x_minus_wind_x,
                        ),
                )
                .sqrt();
        let drag_t_2 = drag_v_x_minus_wind_x * drag_t;
        let drag_t_3 = drag_v_y_minus_wind_y * drag_t;
        let drag_t_4 = drag_v_z_minus_wind_z * drag_t;
        let drag_arm_x = c_1_57 * canopy_r13;
        let drag_arm_y = c_1_57 * canopy_r23;
        let drag_arm_z = c_1_57 * canopy_r33;
        let drag_t_5 = riser_arm_z.fnmadd(riser_force_y, riser_arm_y * riser_force_z)
            + drag_t_3.fnmadd(drag_arm_z, drag_t_4 * drag_arm_y);
        let drag_t_6 = riser_arm_x.fnmadd(riser_force_z, riser_arm_z * riser_force_x)
            + drag_t_4.fnmadd(drag_arm_x, drag_t_2 * drag_arm_z);
        let drag_t_7 = riser_arm_y.fnmadd(riser_force_x, riser_arm_x * riser_force_y)
            + drag_t_2.fnmadd(drag_arm_y, drag_t_3 * drag_arm_x);
        let thruster_t = thruster_couple_x
            + (leg_0_arm_z.fnmadd(leg_0_force_y, leg_0_arm_y * leg_0_force_z)
                + leg_1_arm_z.fnmadd(leg_1_force_y, leg_1_arm_y * leg_1_force_z)
                + leg_2_arm_z.fnmadd(leg_2_force_y, leg_2_arm_y * leg_2_force_z));
        let thruster_t_2 = thruster_couple_y
            + (leg_0_arm_x.fnmadd(leg_0_force_z, leg_0_arm_z * leg_0_force_x)
                + leg_1_arm_x.fnmadd(leg_1_force_z, leg_1_arm_z * leg_1_force_x)
                + leg_2_arm_x.fnmadd(leg_2_force_z, leg_2_arm_z * leg_2_force_x));
        let thruster_t_3 = thruster_couple_z
            + (leg_0_arm_y.fnmadd(leg_0_force_x, leg_0_arm_x * leg_0_force_y)
                + leg_1_arm_y.fnmadd(leg_1_force_x, leg_1_arm_x * leg_1_force_y)
                + leg_2_arm_y.fnmadd(leg_2_force_x, leg_2_arm_x * leg_2_force_y));
        /// `canopy`: forward, what it does.
        let canopy_wx_minus_half = canopy_wx * minus_half;
        let canopy_wy_minus_half = canopy_wy * minus_half;
        let canopy_wz_minus_half = canopy_wz * minus_half;
        let canopy_qw_rate = canopy_qz
            .fmadd(
                canopy_wz_minus_half,
                canopy_qy.fmadd(canopy_wy_minus_half, canopy_qx * canopy_wx_minus_half),
            );
        let canopy_qx_rate = canopy_qw
            .fnmadd(
                canopy_wx_minus_half,
                canopy_qy.fnmadd(canopy_wz_minus_half, canopy_qz * canopy_wy_minus_half),
            );
        let canopy_qy_rate = canopy_qw
            .fnmadd(
                canopy_wy_minus_half,
                canopy_qz.fnmadd(canopy_wx_minus_half, canopy_qx * canopy_wz_minus_half),
            );
        let canopy_qz_rate = canopy_qw
            .fnmadd(
                canopy_wz_minus_half,
                canopy_qx.fnmadd(canopy_wy_minus_half, canopy_qy * canopy_wx_minus_half),
            );
        let canopy_d_z = canopy_z - c_5;
        let canopy_d_squared = canopy_d_z
            .fmadd(canopy_d_z, canopy_y.fmadd(canopy_y, canopy_x * canopy_x));
        let canopy_distance = canopy_d_squared.sqrt();
        let canopy_inverse = one / canopy_distance;
        let canopy_gravity = canopy_inverse * (canopy_inverse * (c_6 * canopy_inverse));
        let canopy_vx_rate = canopy_x
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_x_minus_wind_x.fmadd(drag_t, riser_force_x),
            );
        let canopy_vy_rate = canopy_y
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_y_minus_wind_y.fmadd(drag_t, riser_force_y),
            );
        let canopy_vz_rate = canopy_d_z
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_z_minus_wind_z.fmadd(drag_t, riser_force_z),
            );
        let canopy_torque_x = canopy_r31
            .fmadd(drag_t_7, canopy_r21.fmadd(drag_t_6, canopy_r11 * drag_t_5));
        let canopy_torque_y = canopy_r32
            .fmadd(drag_t_7, canopy_r22.fmadd(drag_t_6, canopy_r12 * drag_t_5));
        let canopy_torque_z = canopy_r33
            .fmadd(drag_t_7, canopy_r23.fmadd(drag_t_6, canopy_r13 * drag_t_5));
        let canopy_gyro_x = c_30 * (canopy_wy * canopy_wz);
        let canopy_gyro_y = c_m30 * (canopy_wx * canopy_wz);
        let canopy_alpha_x = c_7 * (canopy_torque_x - canopy_gyro_x);
        let canopy_alpha_y = c_7 * (canopy_torque_y - canopy_gyro_y);
        let canopy_alpha_z = c_8 * canopy_torque_z;
        /// `capsule`: forward, what it does.
        let capsule_wx_minus_half = capsule_wx * minus_half;
        let capsule_wy_minus_half = capsule_wy * minus_half;
        let capsule_wz_minus_half = capsule_wz * minus_half;
        let capsule_qw_rate = capsule_qz
            .fmadd(
                capsule_wz_minus_half,
                capsule_qy
                    .fmadd(capsule_wy_minus_half, capsule_qx * capsule_wx_minus_half),
            );
        let capsule_qx_rate = capsule_qw
            .fnmadd(
                capsule_wx_minus_half,
                capsule_qy
                    .fnmadd(capsule_wz_minus_half, capsule_qz * capsule_wy_minus_half),
            );
        let capsule_qy_rate = capsule_qw
            .fnmadd(
                capsule_wy_minus_half,
                capsule_qz
                    .fnmadd(capsule_wx_minus_half, capsule_qx * capsule_wz_minus_half),
            );
        let capsule_qz_rate = capsule_qw
            .fnmadd(
                capsule_wz_minus_half,
                capsule_qx
                    .fnmadd(capsule_wy_minus_half, capsule_qy * capsule_wx_minus_half),
            );
        let capsule_d_z = capsule_z - c_5;
        let capsule_d_squared = capsule_d_z
            .fmadd(capsule_d_z, capsule_y.fmadd(capsule_y, capsule_x * capsule_x));
        let capsule_distance = capsule_d_squared.sqrt();
        let capsule_inverse = one / capsule_distance;
        let capsule_gravity = capsule_inverse
            * (capsule_inverse * (c_6 * capsule_inverse));
        let capsule_vx_rate = capsule_x
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_x + (leg_0_force_x + leg_1_force_x + leg_2_force_x)),
            );
        let capsule_vy_rate = capsule_y
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_y + (leg_0_force_y + leg_1_force_y + leg_2_force_y)),
            );
        let capsule_vz_rate = capsule_d_z
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_z + (leg_0_force_z + leg_1_force_z + leg_2_force_z)),
            );
        let capsule_torque_x = capsule_r31
            .fmadd(
                thruster_t_3,
                capsule_r21.fmadd(thruster_t_2, capsule_r11 * thruster_t),
            );
        let capsule_torque_y = capsule_r32
            .fmadd(
                thruster_t_3,
                capsule_r22.fmadd(thruster_t_2, capsule_r12 * thruster_t),
            );
        let capsule_torque_z = capsule_r33
            .fmadd(
                thruster_t_3,
                capsule_r23.fmadd(thruster_t_2, capsule_r13 * thruster_t),
            );
        let capsule_spin_x = c_m1_5.fmadd(capsule_wy, c_300 * capsule_wx);
        let capsule_spin_y = two
            .fmadd(capsule_wz, c_310.fmadd(capsule_wy, c_m1_5 * capsule_wx));
        let capsule_spin_z = c_420.fmadd(capsule_wz, two * capsule_wy);
        let capsule_gyro_x = capsule_wz
            .fnmadd(capsule_spin_y, capsule_wy * capsule_spin_z);
        let capsule_gyro_y = capsule_wx
            .fnmadd(capsule_spin_z, capsule_wz * capsule_spin_x);
        let capsule_gyro_z = capsule_wy
            .fnmadd(capsule_spin_x, capsule_wx * capsule_spin_y);
        let capsule_torque_x_minus_gyro_x = capsule_torque_x - capsule_gyro_x;
        let capsule_torque_y_minus_gyro_y = capsule_torque_y - capsule_gyro_y;
        let capsule_torque_z_minus_gyro_z = capsule_torque_z - capsule_gyro_z;
        let capsule_alpha_x = c_12
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_11
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_9 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        let capsule_alpha_y = c_14
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_13
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_11 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        let capsule_alpha_z = c_15
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_14
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_12 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        *out = [
            canopy_vx,
            canopy_vy,
            canopy_vz,
            canopy_qw_rate,
            canopy_qx_rate,
            canopy_qy_rate,
            canopy_qz_rate,
            capsule_vx,
            capsule_vy,
            capsule_vz,
            capsule_qw_rate,
            capsule_qx_rate,
            capsule_qy_rate,
            capsule_qz_rate,
            canopy_vx_rate,
            canopy_vy_rate,
            canopy_vz_rate,
            canopy_alpha_x,
            canopy_alpha_y,
            canopy_alpha_z,
            capsule_vx_rate,
            capsule_vy_rate,
            capsule_vz_rate,
            capsule_alpha_x,
            capsule_alpha_y,
            capsule_alpha_z,
            confluence_wx,
            confluence_wy,
            confluence_wz,
        ];
    }
    /// State derivative with the velocities of the nodes found along with it, `D w = Σ (K s + C u·v) u` over the lines that carry.
    /// 29 ẋ, then 4 anchors × 6 [m, m/s], 1 nodes × 3 loads [N], per node `det D − 1e-5 (tr D)³` [N³ s³/m³], the largest term of a pull and the largest pull [N], whether its lines do what was held of them (> 0), per line stretch [m].
    /// 790 operations (335 additions, 394 multiplications, 7 divisions, 7 roots, 0 trigonometric, 47 selections).
    #[inline(never)]
    fn rates<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        hold: &[T; 4],
        inputs: &[T; 9],
        params: &[T; 3],
        derived: &[T; 2],
        out: &mut [T; 64],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, canopy_wz,
        capsule_vx, capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [riser_hold, leg_0_hold, leg_1_hold, leg_2_hold] = *hold;
        let [wind_x, wind_y, wind_z, thruster_x, thruster_y, thruster_z,
        thruster_couple_x, thruster_couple_y, thruster_couple_z] = *inputs;
        let [riser_k, _, _] = *params;
        let [capsule_inverse_mass, derived_1] = *derived;
        let c_m9_5 = T::from_f64(-9.5);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        let c_0_25 = T::from_f64(0.25);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c_1em5 = T::from_f64(1e-5);
        let half = T::from_f64(0.5);
        let c_1_57 = T::from_f64(1.57);
        let minus_half = T::from_f64(-0.5);
        let c_0_0625 = T::from_f64(0.0625);
        let c_5 = T::from_f64(-3404590.0);
        let c_6 = T::from_f64(4.2828e13);
        let c_30 = T::from_f64(30.0);
        let c_m30 = T::from_f64(-30.0);
        let c_7 = T::from_f64(0.016666666666666666);
        let c_8 = T::from_f64(0.011111111111111112);
        let c_300 = T::from_f64(300.0);
        let c_m1_5 = T::from_f64(-1.5);
        let c_310 = T::from_f64(310.0);
        let two = T::from_f64(2.0);
        let c_420 = T::from_f64(420.0);
        let c_9 = T::from_f64(0.003333413982923537);
        let c_11 = T::from_f64(1.6129918040814068e-5);
        let c_12 = T::from_f64(-7.680913352768604e-8);
        let c_13 = T::from_f64(0.003225983608162814);
        let c_14 = T::from_f64(-1.536182670553721e-5);
        let c_15 = T::from_f64(0.002381025532508121);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_t = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_2 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_3 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_3, capsule_r12.fmadd(leg_1_t_2, capsule_r11 * leg_1_t));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_3, capsule_r22.fmadd(leg_1_t_2, capsule_r21 * leg_1_t));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_3, capsule_r32.fmadd(leg_1_t_2, capsule_r31 * leg_1_t));
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_t = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_2 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_3 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_3, capsule_r12.fmadd(leg_2_t_2, capsule_r11 * leg_2_t));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_3, capsule_r22.fmadd(leg_2_t_2, capsule_r21 * leg_2_t));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_3, capsule_r32.fmadd(leg_2_t_2, capsule_r31 * leg_2_t));
        let leg_2_t_4 = leg_2_v_x + (leg_1_v_x + (riser_v_x + leg_0_v_x));
        let leg_2_t_5 = leg_2_v_y + (leg_1_v_y + (riser_v_y + leg_0_v_y));
        let leg_2_t_6 = leg_2_v_z + (leg_1_v_z + (riser_v_z + leg_0_v_z));
        /// `riser`.
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_pull = c_600
            .fmadd(
                riser_u_z
                    .fmadd(
                        leg_2_t_6.fmsub(c_0_25, riser_v_z),
                        riser_u_y
                            .fmadd(
                                leg_2_t_5.fmsub(c_0_25, riser_v_y),
                                riser_u_x * leg_2_t_4.fmsub(c_0_25, riser_v_x),
                            ),
                    ),
                riser_k * riser_stretch,
            );
        let riser_t_2 = zero.lt(riser_hold);
        let riser_t_3 = T::select(riser_t_2, c_600, zero);
        let riser_t_4 = T::select(riser_t_2, -riser_pull, zero);
        let riser_t_5 = riser_u_x * riser_t_3;
        let riser_t_6 = riser_u_y * riser_t_3;
        /// `leg[0]`.
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t_2 = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t_2;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t_2 - c_2_1;
        let leg_0_pull = c_470
            .fmadd(
                leg_0_u_z
                    .fmadd(
                        leg_2_t_6.fmsub(c_0_25, leg_0_v_z),
                        leg_0_u_y
                            .fmadd(
                                leg_2_t_5.fmsub(c_0_25, leg_0_v_y),
                                leg_0_u_x * leg_2_t_4.fmsub(c_0_25, leg_0_v_x),
                            ),
                    ),
                c_47000 * leg_0_stretch,
            );
        let leg_0_t_3 = zero.lt(leg_0_hold);
        let leg_0_t_4 = T::select(leg_0_t_3, c_470, zero);
        let leg_0_t_5 = T::select(leg_0_t_3, -leg_0_pull, zero);
        let leg_0_t_6 = leg_0_u_x * leg_0_t_4;
        let leg_0_t_7 = leg_0_u_y * leg_0_t_4;
        /// `leg[1]`.
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t_4 = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t_4;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t_4 - c_2_1;
        let leg_1_pull = c_470
            .fmadd(
                leg_1_u_z
                    .fmadd(
                        leg_2_t_6.fmsub(c_0_25, leg_1_v_z),
                        leg_1_u_y
                            .fmadd(
                                leg_2_t_5.fmsub(c_0_25, leg_1_v_y),
                                leg_1_u_x * leg_2_t_4.fmsub(c_0_25, leg_1_v_x),
                            ),
                    ),
                c_47000 * leg_1_stretch,
            );
        let leg_1_t_5 = zero.lt(leg_1_hold);
        let leg_1_t_6 = T::select(leg_1_t_5, c_470, zero);
        let leg_1_t_7 = T::select(leg_1_t_5, -leg_1_pull, zero);
        let leg_1_t_8 = leg_1_u_x * leg_1_t_6;
        let leg_1_t_9 = leg_1_u_y * leg_1_t_6;
        /// `leg[2]`.
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t_7 = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t_7;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t_7 - c_2_1;
        let leg_2_pull = c_470
            .fmadd(
                leg_2_u_z
                    .fmadd(
                        leg_2_t_6.fmsub(c_0_25, leg_2_v_z),
                        leg_2_u_y
                            .fmadd(
                                leg_2_t_5.fmsub(c_0_25, leg_2_v_y),
                                leg_2_u_x * leg_2_t_4.fmsub(c_0_25, leg_2_v_x),
                            ),
                    ),
                c_47000 * leg_2_stretch,
            );
        let leg_2_t_8 = zero.lt(leg_2_hold);
        let leg_2_t_9 = T::select(leg_2_t_8, c_470, zero);
        let leg_2_t_10 = T::select(leg_2_t_8, -leg_2_pull, zero);
        let leg_2_t_11 = leg_2_u_x * leg_2_t_9;
        let leg_2_t_12 = leg_2_u_y * leg_2_t_9;
        let leg_2_t_13 = leg_2_u_x
            .fmadd(
                leg_2_t_11,
                leg_1_u_x
                    .fmadd(leg_1_t_8, leg_0_u_x.fmadd(leg_0_t_6, riser_u_x * riser_t_5)),
            );
        let leg_2_t_14 = leg_2_u_y
            .fmadd(
                leg_2_t_11,
                leg_1_u_y
                    .fmadd(leg_1_t_8, leg_0_u_y.fmadd(leg_0_t_6, riser_u_y * riser_t_5)),
            );
        let leg_2_t_15 = leg_2_u_z
            .fmadd(
                leg_2_t_11,
                leg_1_u_z
                    .fmadd(leg_1_t_8, leg_0_u_z.fmadd(leg_0_t_6, riser_u_z * riser_t_5)),
            );
        let leg_2_t_16 = leg_2_u_y
            .fmadd(
                leg_2_t_12,
                leg_1_u_y
                    .fmadd(leg_1_t_9, leg_0_u_y.fmadd(leg_0_t_7, riser_u_y * riser_t_6)),
            );
        let leg_2_t_17 = leg_2_u_z
            .fmadd(
                leg_2_t_12,
                leg_1_u_z
                    .fmadd(leg_1_t_9, leg_0_u_z.fmadd(leg_0_t_7, riser_u_z * riser_t_6)),
            );
        let leg_2_t_18 = leg_2_u_z
            .fmadd(
                leg_2_u_z * leg_2_t_9,
                leg_1_u_z
                    .fmadd(
                        leg_1_u_z * leg_1_t_6,
                        leg_0_u_z
                            .fmadd(
                                leg_0_u_z * leg_0_t_4,
                                riser_u_z * (riser_u_z * riser_t_3),
                            ),
                    ),
            );
        let leg_2_t_19 = leg_2_u_x
            .fmadd(
                leg_2_t_10,
                leg_1_u_x
                    .fmadd(leg_1_t_7, leg_0_u_x.fmadd(leg_0_t_5, riser_u_x * riser_t_4)),
            );
        let leg_2_t_20 = leg_2_u_y
            .fmadd(
                leg_2_t_10,
                leg_1_u_y
                    .fmadd(leg_1_t_7, leg_0_u_y.fmadd(leg_0_t_5, riser_u_y * riser_t_4)),
            );
        let leg_2_t_21 = leg_2_u_z
            .fmadd(
                leg_2_t_10,
                leg_1_u_z
                    .fmadd(leg_1_t_7, leg_0_u_z.fmadd(leg_0_t_5, riser_u_z * riser_t_4)),
            );
        let leg_2_t_22 = leg_2_t_17.fnmadd(leg_2_t_17, leg_2_t_16 * leg_2_t_18);
        let leg_2_t_23 = leg_2_t_14.fnmadd(leg_2_t_18, leg_2_t_15 * leg_2_t_17);
        let leg_2_t_24 = leg_2_t_15.fnmadd(leg_2_t_16, leg_2_t_14 * leg_2_t_17);
        let leg_2_t_25 = leg_2_t_13.fnmadd(leg_2_t_17, leg_2_t_14 * leg_2_t_15);
        let leg_2_det = leg_2_t_15
            .fmadd(leg_2_t_24, leg_2_t_14.fmadd(leg_2_t_23, leg_2_t_13 * leg_2_t_22));
        let leg_2_t_26 = leg_2_t_18 + (leg_2_t_13 + leg_2_t_16);
        let leg_2_margin = c_1em5
            .fnmadd(leg_2_t_26 * (leg_2_t_26 * leg_2_t_26), leg_2_det);
        let leg_2_t_27 = one / T::select(zero.lt(leg_2_margin), leg_2_det, one);
        let leg_2_t_28 = leg_2_t_21
            .fmadd(leg_2_t_24, leg_2_t_20.fmadd(leg_2_t_23, leg_2_t_19 * leg_2_t_22));
        let leg_2_t_29 = leg_2_t_21
            .fmadd(
                leg_2_t_25,
                leg_2_t_20
                    .fmadd(
                        leg_2_t_15.fnmadd(leg_2_t_15, leg_2_t_13 * leg_2_t_18),
                        leg_2_t_19 * leg_2_t_23,
                    ),
            );
        let leg_2_t_30 = leg_2_t_21
            .fmadd(
                leg_2_t_14.fnmadd(leg_2_t_14, leg_2_t_13 * leg_2_t_16),
                leg_2_t_20.fmadd(leg_2_t_25, leg_2_t_19 * leg_2_t_24),
            );
        let leg_2_t_31 = leg_2_t_27 * leg_2_t_28;
        let leg_2_t_32 = leg_2_t_27 * leg_2_t_29;
        let leg_2_t_33 = leg_2_t_27 * leg_2_t_30;
        let riser_t_7 = riser_u_z
            .fmadd(leg_2_t_33, riser_u_y.fmadd(leg_2_t_32, riser_u_x * leg_2_t_31));
        let riser_pull_2 = c_600.fmadd(riser_t_7, riser_pull);
        let riser_tension = T::select(riser_t_2, riser_pull_2, zero);
        let leg_0_t_8 = leg_0_u_z
            .fmadd(leg_2_t_33, leg_0_u_y.fmadd(leg_2_t_32, leg_0_u_x * leg_2_t_31));
        let leg_0_pull_2 = c_470.fmadd(leg_0_t_8, leg_0_pull);
        let leg_0_tension = T::select(leg_0_t_3, leg_0_pull_2, zero);
        /// `leg[1]`.
        let leg_1_t_10 = leg_1_u_z
            .fmadd(leg_2_t_33, leg_1_u_y.fmadd(leg_2_t_32, leg_1_u_x * leg_2_t_31));
        let leg_1_t_11 = T::select(
            leg_1_t_5,
            leg_1_pull.abs() + (c_470 * leg_1_t_10).abs(),
            zero,
        );
        let leg_1_t_12 = T::select(
                riser_t_2,
                riser_pull.abs() + (c_600 * riser_t_7).abs(),
                zero,
            )
            .max(
                T::select(leg_0_t_3, leg_0_pull.abs() + (c_470 * leg_0_t_8).abs(), zero),
            )
            .max(leg_1_t_11);
        let leg_1_pull_2 = c_470.fmadd(leg_1_t_10, leg_1_pull);
        let leg_1_tension = T::select(leg_1_t_5, leg_1_pull_2, zero);
        /// `leg[2]`.
        let leg_2_t_34 = leg_2_u_z
            .fmadd(leg_2_t_33, leg_2_u_y.fmadd(leg_2_t_32, leg_2_u_x * leg_2_t_31));
        let leg_2_t_35 = leg_1_t_12
            .max(
                T::select(leg_2_t_8, leg_2_pull.abs() + (c_470 * leg_2_t_34).abs(), zero),
            );
        let leg_2_pull_2 = c_470.fmadd(leg_2_t_34, leg_2_pull);
        let leg_2_tension = T::select(leg_2_t_8, leg_2_pull_2, zero);
        let leg_2_t_36 = riser_tension
            .max(leg_0_tension)
            .max(leg_1_tension)
            .max(leg_2_tension);
        let leg_2_t_37 = leg_2_stretch.min(leg_2_pull_2) * (leg_2_hold - half);
        let leg_2_agreed = (riser_stretch.min(riser_pull_2) * (riser_hold - half))
            .min(leg_0_stretch.min(leg_0_pull_2) * (leg_0_hold - half))
            .min(leg_1_stretch.min(leg_1_pull_2) * (leg_1_hold - half))
            .min(leg_2_t_37);
        let confluence_x_rate = leg_2_t_27.fmadd(leg_2_t_28, leg_2_t_4 * c_0_25);
        let confluence_y_rate = leg_2_t_27.fmadd(leg_2_t_29, leg_2_t_5 * c_0_25);
        let confluence_z_rate = leg_2_t_27.fmadd(leg_2_t_30, leg_2_t_6 * c_0_25);
        let riser_force_x = riser_u_x * riser_tension;
        let riser_force_y = riser_u_y * riser_tension;
        let riser_force_z = riser_u_z * riser_tension;
        let leg_0_force_x = leg_0_u_x * leg_0_tension;
        let leg_0_force_y = leg_0_u_y * leg_0_tension;
        let leg_0_force_z = leg_0_u_z * leg_0_tension;
        let leg_1_force_x = leg_1_u_x * leg_1_tension;
        let leg_1_force_y = leg_1_u_y * leg_1_tension;
        let leg_1_force_z = leg_1_u_z * leg_1_tension;
        let leg_2_force_x = leg_2_u_x * leg_2_tension;
        let leg_2_force_y = leg_2_u_y * leg_2_tension;
        let leg_2_force_z = leg_2_u_z * leg_2_tension;
        /// `drag`: load.
        let drag_scaled_canopy_wy = c_1_57 * canopy_wy;
        let drag_scaled_canopy_wx = c_1_57 * canopy_wx;
        let drag_v_x = canopy_vx
            + canopy_r12
                .fnmadd(drag_scaled_canopy_wx, canopy_r11 * drag_scaled_canopy_wy);
        let drag_v_y = canopy_vy
            + canopy_r22
                .fnmadd(drag_scaled_canopy_wx, canopy_r21 * drag_scaled_canopy_wy);
        let drag_v_z = canopy_vz
            + canopy_r32
                .fnmadd(drag_scaled_canopy_wx, canopy_r31 * drag_scaled_canopy_wy);
        let drag_v_x_minus_wind_x = drag_v_x - wind_x;
        let drag_v_y_minus_wind_y = drag_v_y - wind_y;
        let drag_v_z_minus_wind_z = drag_v_z - wind_z;
        let drag_t = derived_1
            * drag_v_z_minus_wind_z
                .fmadd(
                    drag_v_z_minus_wind_z,
                    drag_v_y_minus_wind_y
                        .fmadd(
                            drag_v_y_minus_wind_y,
                            drag_v_x_minus_wind_x * drag_v_x_minus_wind_x,
                        ),
                )
                .sqrt();
        let drag_t_2 = drag_v_x_minus_wind_x * drag_t;
        let drag_t_3 = drag_v_y_minus_wind_y * drag_t;
        let drag_t_4 = drag_v_z_minus_wind_z * drag_t;
        let drag_arm_x = c_1_57 * canopy_r13;
        let drag_arm_y = c_1_57 * canopy_r23;
        let drag_arm_z = c_1_57 * canopy_r33;
        let drag_t_5 = drag_t_3.fnmadd(drag_arm_z, drag_t_4 * drag_arm_y)
            + riser_arm_z.fnmadd(riser_force_y, riser_arm_y * riser_force_z);
        let drag_t_6 = drag_t_4.fnmadd(drag_arm_x, drag_t_2 * drag_arm_z)
            + riser_arm_x.fnmadd(riser_force_z, riser_arm_z * riser_force_x);
        let drag_t_7 = drag_t_2.fnmadd(drag_arm_y, drag_t_3 * drag_arm_x)
            + riser_arm_y.fnmadd(riser_force_x, riser_arm_x * riser_force_y);
        let thruster_t = thruster_couple_x
            + (leg_0_arm_z.fnmadd(leg_0_force_y, leg_0_arm_y * leg_0_force_z)
                + leg_1_arm_z.fnmadd(leg_1_force_y, leg_1_arm_y * leg_1_force_z)
                + leg_2_arm_z.fnmadd(leg_2_force_y, leg_2_arm_y * leg_2_force_z));
        let thruster_t_2 = thruster_couple_y
            + (leg_0_arm_x.fnmadd(leg_0_force_z, leg_0_arm_z * leg_0_force_x)
                + leg_1_arm_x.fnmadd(leg_1_force_z, leg_1_arm_z * leg_1_force_x)
                + leg_2_arm_x.fnmadd(leg_2_force_z, leg_2_arm_z * leg_2_force_x));
        let thruster_t_3 = thruster_couple_z
            + (leg_0_arm_y.fnmadd(leg_0_force_x, leg_0_arm_x * leg_0_force_y)
                + leg_1_arm_y.fnmadd(leg_1_force_x, leg_1_arm_x * leg_1_force_y)
                + leg_2_arm_y.fnmadd(leg_2_force_x, leg_2_arm_x * leg_2_force_y));
        /// `canopy`.
        let canopy_wx_minus_half = canopy_wx * minus_half;
        let canopy_wy_minus_half = canopy_wy * minus_half;
        let canopy_wz_minus_half = canopy_wz * minus_half;
        let canopy_qw_rate = canopy_qz
            .fmadd(
                canopy_wz_minus_half,
                canopy_qy.fmadd(canopy_wy_minus_half, canopy_qx * canopy_wx_minus_half),
            );
        let canopy_qx_rate = canopy_qw
            .fnmadd(
                canopy_wx_minus_half,
                canopy_qy.fnmadd(canopy_wz_minus_half, canopy_qz * canopy_wy_minus_half),
            );
        let canopy_qy_rate = canopy_qw
            .fnmadd(
                canopy_wy_minus_half,
                canopy_qz.fnmadd(canopy_wx_minus_half, canopy_qx * canopy_wz_minus_half),
            );
        let canopy_qz_rate = canopy_qw
            .fnmadd(
                canopy_wz_minus_half,
                canopy_qx.fnmadd(canopy_wy_minus_half, canopy_qy * canopy_wx_minus_half),
            );
        let canopy_d_z = canopy_z - c_5;
        let canopy_d_squared = canopy_d_z
            .fmadd(canopy_d_z, canopy_y.fmadd(canopy_y, canopy_x * canopy_x));
        let canopy_distance = canopy_d_squared.sqrt();
        let canopy_inverse = one / canopy_distance;
        let canopy_gravity = canopy_inverse * (canopy_inverse * (c_6 * canopy_inverse));
        let canopy_vx_rate = canopy_x
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_x_minus_wind_x.fmadd(drag_t, riser_force_x),
            );
        let canopy_vy_rate = canopy_y
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_y_minus_wind_y.fmadd(drag_t, riser_force_y),
            );
        let canopy_vz_rate = canopy_d_z
            .fnmadd(
                canopy_gravity,
                c_0_0625 * drag_v_z_minus_wind_z.fmadd(drag_t, riser_force_z),
            );
        let canopy_torque_x = canopy_r31
            .fmadd(drag_t_7, canopy_r21.fmadd(drag_t_6, canopy_r11 * drag_t_5));
        let canopy_torque_y = canopy_r32
            .fmadd(drag_t_7, canopy_r22.fmadd(drag_t_6, canopy_r12 * drag_t_5));
        let canopy_torque_z = canopy_r33
            .fmadd(drag_t_7, canopy_r23.fmadd(drag_t_6, canopy_r13 * drag_t_5));
        let canopy_gyro_x = c_30 * (canopy_wy * canopy_wz);
        let canopy_gyro_y = c_m30 * (canopy_wx * canopy_wz);
        let canopy_alpha_x = c_7 * (canopy_torque_x - canopy_gyro_x);
        let canopy_alpha_y = c_7 * (canopy_torque_y - canopy_gyro_y);
        let canopy_alpha_z = c_8 * canopy_torque_z;
        /// `capsule`.
        let capsule_wx_minus_half = capsule_wx * minus_half;
        let capsule_wy_minus_half = capsule_wy * minus_half;
        let capsule_wz_minus_half = capsule_wz * minus_half;
        let capsule_qw_rate = capsule_qz
            .fmadd(
                capsule_wz_minus_half,
                capsule_qy
                    .fmadd(capsule_wy_minus_half, capsule_qx * capsule_wx_minus_half),
            );
        let capsule_qx_rate = capsule_qw
            .fnmadd(
                capsule_wx_minus_half,
                capsule_qy
                    .fnmadd(capsule_wz_minus_half, capsule_qz * capsule_wy_minus_half),
            );
        let capsule_qy_rate = capsule_qw
            .fnmadd(
                capsule_wy_minus_half,
                capsule_qz
                    .fnmadd(capsule_wx_minus_half, capsule_qx * capsule_wz_minus_half),
            );
        let capsule_qz_rate = capsule_qw
            .fnmadd(
                capsule_wz_minus_half,
                capsule_qx
                    .fnmadd(capsule_wy_minus_half, capsule_qy * capsule_wx_minus_half),
            );
        let capsule_d_z = capsule_z - c_5;
        let capsule_d_squared = capsule_d_z
            .fmadd(capsule_d_z, capsule_y.fmadd(capsule_y, capsule_x * capsule_x));
        let capsule_distance = capsule_d_squared.sqrt();
        let capsule_inverse = one / capsule_distance;
        let capsule_gravity = capsule_inverse
            * (capsule_inverse * (c_6 * capsule_inverse));
        let capsule_vx_rate = capsule_x
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_x + (leg_0_force_x + leg_1_force_x + leg_2_force_x)),
            );
        let capsule_vy_rate = capsule_y
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_y + (leg_0_force_y + leg_1_force_y + leg_2_force_y)),
            );
        let capsule_vz_rate = capsule_d_z
            .fnmadd(
                capsule_gravity,
                capsule_inverse_mass
                    * (thruster_z + (leg_0_force_z + leg_1_force_z + leg_2_force_z)),
            );
        let capsule_torque_x = capsule_r31
            .fmadd(
                thruster_t_3,
                capsule_r21.fmadd(thruster_t_2, capsule_r11 * thruster_t),
            );
        let capsule_torque_y = capsule_r32
            .fmadd(
                thruster_t_3,
                capsule_r22.fmadd(thruster_t_2, capsule_r12 * thruster_t),
            );
        let capsule_torque_z = capsule_r33
            .fmadd(
                thruster_t_3,
                capsule_r23.fmadd(thruster_t_2, capsule_r13 * thruster_t),
            );
        let capsule_spin_x = c_m1_5.fmadd(capsule_wy, c_300 * capsule_wx);
        let capsule_spin_y = two
            .fmadd(capsule_wz, c_310.fmadd(capsule_wy, c_m1_5 * capsule_wx));
        let capsule_spin_z = c_420.fmadd(capsule_wz, two * capsule_wy);
        let capsule_gyro_x = capsule_wz
            .fnmadd(capsule_spin_y, capsule_wy * capsule_spin_z);
        let capsule_gyro_y = capsule_wx
            .fnmadd(capsule_spin_z, capsule_wz * capsule_spin_x);
        let capsule_gyro_z = capsule_wy
            .fnmadd(capsule_spin_x, capsule_wx * capsule_spin_y);
        let capsule_torque_x_minus_gyro_x = capsule_torque_x - capsule_gyro_x;
        let capsule_torque_y_minus_gyro_y = capsule_torque_y - capsule_gyro_y;
        let capsule_torque_z_minus_gyro_z = capsule_torque_z - capsule_gyro_z;
        let capsule_alpha_x = c_12
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_11
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_9 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        let capsule_alpha_y = c_14
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_13
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_11 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        let capsule_alpha_z = c_15
            .fmadd(
                capsule_torque_z_minus_gyro_z,
                c_14
                    .fmadd(
                        capsule_torque_y_minus_gyro_y,
                        c_12 * capsule_torque_x_minus_gyro_x,
                    ),
            );
        *out = [
            canopy_vx,
            canopy_vy,
            canopy_vz,
            canopy_qw_rate,
            canopy_qx_rate,
            canopy_qy_rate,
            canopy_qz_rate,
            capsule_vx,
            capsule_vy,
            capsule_vz,
            capsule_qw_rate,
            capsule_qx_rate,
            capsule_qy_rate,
            capsule_qz_rate,
            canopy_vx_rate,
            canopy_vy_rate,
            canopy_vz_rate,
            canopy_alpha_x,
            canopy_alpha_y,
            canopy_alpha_z,
            capsule_vx_rate,
            capsule_vy_rate,
            capsule_vz_rate,
            capsule_alpha_x,
            capsule_alpha_y,
            capsule_alpha_z,
            confluence_x_rate,
            confluence_y_rate,
            confluence_z_rate,
            riser_p_x,
            riser_p_y,
            riser_p_z,
            riser_v_x,
            riser_v_y,
            riser_v_z,
            leg_0_p_x,
            leg_0_p_y,
            leg_0_p_z,
            leg_0_v_x,
            leg_0_v_y,
            leg_0_v_z,
            leg_1_p_x,
            leg_1_p_y,
            leg_1_p_z,
            leg_1_v_x,
            leg_1_v_y,
            leg_1_v_z,
            leg_2_p_x,
            leg_2_p_y,
            leg_2_p_z,
            leg_2_v_x,
            leg_2_v_y,
            leg_2_v_z,
            zero,
            zero,
            zero,
            leg_2_margin,
            leg_2_t_35,
            leg_2_t_36,
            leg_2_agreed,
            riser_stretch,
            leg_0_stretch,
            leg_1_stretch,
            leg_2_stretch,
        ];
    }
    /// Balance of the nodes: `r = Σ T u + W`, the forces on each node.
    /// 3 [N], world axes; zero where the nodes are in equilibrium.
    /// 343 operations (159 additions, 144 multiplications, 4 divisions, 4 roots, 0 trigonometric, 32 selections).
    #[inline(never)]
    fn balance<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        params: &[T; 3],
        out: &mut [T; 3],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, _, capsule_vx,
        capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, leg_0_hold, leg_1_hold, leg_2_hold] = *hold;
        let [riser_k, _, _] = *params;
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        let riser_force_x = riser_u_x * riser_tension;
        let riser_force_y = riser_u_y * riser_tension;
        let riser_force_z = riser_u_z * riser_tension;
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t - c_2_1;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t_2 = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t_2, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t_2, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t_2, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        let leg_0_rate = leg_0_u_z
            .fmadd(
                confluence_wz - leg_0_v_z,
                leg_0_u_y
                    .fmadd(
                        confluence_wy - leg_0_v_y,
                        leg_0_u_x * (confluence_wx - leg_0_v_x),
                    ),
            );
        let leg_0_pull = c_470.fmadd(leg_0_rate, c_47000 * leg_0_stretch);
        let leg_0_tension = T::select(
            zero.lt(leg_0_hold),
            leg_0_pull,
            T::select(
                leg_0_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_0_stretch), leg_0_pull.max(zero), zero),
            ),
        );
        let leg_0_force_x = leg_0_u_x * leg_0_tension;
        let leg_0_force_y = leg_0_u_y * leg_0_tension;
        let leg_0_force_z = leg_0_u_z * leg_0_tension;
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t - c_2_1;
        let leg_1_t_2 = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_3 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_4 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_4, capsule_r12.fmadd(leg_1_t_3, capsule_r11 * leg_1_t_2));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_4, capsule_r22.fmadd(leg_1_t_3, capsule_r21 * leg_1_t_2));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_4, capsule_r32.fmadd(leg_1_t_3, capsule_r31 * leg_1_t_2));
        let leg_1_rate = leg_1_u_z
            .fmadd(
                confluence_wz - leg_1_v_z,
                leg_1_u_y
                    .fmadd(
                        confluence_wy - leg_1_v_y,
                        leg_1_u_x * (confluence_wx - leg_1_v_x),
                    ),
            );
        let leg_1_pull = c_470.fmadd(leg_1_rate, c_47000 * leg_1_stretch);
        let leg_1_tension = T::select(
            zero.lt(leg_1_hold),
            leg_1_pull,
            T::select(
                leg_1_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_1_stretch), leg_1_pull.max(zero), zero),
            ),
        );
        let leg_1_force_x = leg_1_u_x * leg_1_tension;
        let leg_1_force_y = leg_1_u_y * leg_1_tension;
        let leg_1_force_z = leg_1_u_z * leg_1_tension;
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t - c_2_1;
        let leg_2_t_2 = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_3 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_4 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_4, capsule_r12.fmadd(leg_2_t_3, capsule_r11 * leg_2_t_2));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_4, capsule_r22.fmadd(leg_2_t_3, capsule_r21 * leg_2_t_2));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_4, capsule_r32.fmadd(leg_2_t_3, capsule_r31 * leg_2_t_2));
        let leg_2_rate = leg_2_u_z
            .fmadd(
                confluence_wz - leg_2_v_z,
                leg_2_u_y
                    .fmadd(
                        confluence_wy - leg_2_v_y,
                        leg_2_u_x * (confluence_wx - leg_2_v_x),
                    ),
            );
        let leg_2_pull = c_470.fmadd(leg_2_rate, c_47000 * leg_2_stretch);
        let leg_2_tension = T::select(
            zero.lt(leg_2_hold),
            leg_2_pull,
            T::select(
                leg_2_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_2_stretch), leg_2_pull.max(zero), zero),
            ),
        );
        let leg_2_force_x = leg_2_u_x * leg_2_tension;
        let leg_2_force_y = leg_2_u_y * leg_2_tension;
        let leg_2_force_z = leg_2_u_z * leg_2_tension;
        let leg_2_t_5 = -(riser_force_x + leg_0_force_x + leg_1_force_x + leg_2_force_x);
        let leg_2_t_6 = -(riser_force_y + leg_0_force_y + leg_1_force_y + leg_2_force_y);
        let leg_2_t_7 = -(riser_force_z + leg_0_force_z + leg_1_force_z + leg_2_force_z);
        *out = [leg_2_t_5, leg_2_t_6, leg_2_t_7];
    }
    /// Guards: stretch `s = d − L0` and pull `K s + C ṡ` of each line, depth and pull of each stop, then the declared events.
    /// 4 lines × 2 [m, N], 0 stops × 2 [m, N or rad, N m], 1 events.
    /// 299 operations (147 additions, 132 multiplications, 4 divisions, 4 roots, 0 trigonometric, 12 selections).
    #[inline(never)]
    fn guards<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        params: &[T; 3],
        out: &mut [T; 9],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, _, capsule_vx,
        capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, _, _, _] = *hold;
        let [riser_k, _, _] = *params;
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t - c_2_1;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t_2 = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t_2, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t_2, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t_2, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        let leg_0_rate = leg_0_u_z
            .fmadd(
                confluence_wz - leg_0_v_z,
                leg_0_u_y
                    .fmadd(
                        confluence_wy - leg_0_v_y,
                        leg_0_u_x * (confluence_wx - leg_0_v_x),
                    ),
            );
        let leg_0_pull = c_470.fmadd(leg_0_rate, c_47000 * leg_0_stretch);
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t - c_2_1;
        let leg_1_t_2 = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_3 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_4 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_4, capsule_r12.fmadd(leg_1_t_3, capsule_r11 * leg_1_t_2));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_4, capsule_r22.fmadd(leg_1_t_3, capsule_r21 * leg_1_t_2));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_4, capsule_r32.fmadd(leg_1_t_3, capsule_r31 * leg_1_t_2));
        let leg_1_rate = leg_1_u_z
            .fmadd(
                confluence_wz - leg_1_v_z,
                leg_1_u_y
                    .fmadd(
                        confluence_wy - leg_1_v_y,
                        leg_1_u_x * (confluence_wx - leg_1_v_x),
                    ),
            );
        let leg_1_pull = c_470.fmadd(leg_1_rate, c_47000 * leg_1_stretch);
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t - c_2_1;
        let leg_2_t_2 = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_3 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_4 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_4, capsule_r12.fmadd(leg_2_t_3, capsule_r11 * leg_2_t_2));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_4, capsule_r22.fmadd(leg_2_t_3, capsule_r21 * leg_2_t_2));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_4, capsule_r32.fmadd(leg_2_t_3, capsule_r31 * leg_2_t_2));
        let leg_2_rate = leg_2_u_z
            .fmadd(
                confluence_wz - leg_2_v_z,
                leg_2_u_y
                    .fmadd(
                        confluence_wy - leg_2_v_y,
                        leg_2_u_x * (confluence_wx - leg_2_v_x),
                    ),
            );
        let leg_2_pull = c_470.fmadd(leg_2_rate, c_47000 * leg_2_stretch);
        let riser_t_2 = riser_tension.max(zero);
        *out = [
            riser_stretch,
            riser_pull,
            leg_0_stretch,
            leg_0_pull,
            leg_1_stretch,
            leg_1_pull,
            leg_2_stretch,
            leg_2_pull,
            riser_t_2,
        ];
    }
    /// The declared outputs.
    /// 2 columns, each in its unit.
    /// 100 operations (45 additions, 42 multiplications, 1 divisions, 2 roots, 1 trigonometric, 9 selections).
    #[inline(never)]
    fn outputs<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        params: &[T; 3],
        out: &mut [T; 2],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz, _,
        _, _, capsule_qw, capsule_qx, capsule_qy, capsule_qz] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, _, _, _, _, _, _, _,
        ] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, _, _, _] = *hold;
        let [riser_k, _, _] = *params;
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww - capsule_q_xx - (capsule_q_yy - capsule_q_zz);
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        let riser_t_2 = riser_tension.max(zero);
        let tilt_t = capsule_r13
            .fmadd(capsule_r13, capsule_r23 * capsule_r23)
            .sqrt()
            .atan2(capsule_r33);
        *out = [riser_t_2, tilt_t];
    }
    /// Energy and power: `½ v·M v`, gravity, `Σ ½ K s₊²`, power of the loads, of the dampers, of prescribed motions.
    /// 6 [J, J, J, W, W, W].
    /// 490 operations (210 additions, 225 multiplications, 8 divisions, 7 roots, 0 trigonometric, 40 selections).
    #[inline(never)]
    fn energy<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        inputs: &[T; 9],
        params: &[T; 3],
        derived: &[T; 2],
        out: &mut [T; 6],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, canopy_wz,
        capsule_vx, capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, leg_0_hold, leg_1_hold, leg_2_hold] = *hold;
        let [wind_x, wind_y, wind_z, thruster_x, thruster_y, thruster_z,
        thruster_couple_x, thruster_couple_y, thruster_couple_z] = *inputs;
        let [riser_k, m_cap, _] = *params;
        let [_, derived_1] = *derived;
        let c_60 = T::from_f64(60.0);
        let c_90 = T::from_f64(90.0);
        let c_16 = T::from_f64(16.0);
        let half = T::from_f64(0.5);
        let c = T::from_f64(-3404590.0);
        let c_2 = T::from_f64(4.2828e13);
        let c_3 = T::from_f64(-6809180.0);
        let c_4 = T::from_f64(3404590.0);
        let c_300 = T::from_f64(300.0);
        let c_m1_5 = T::from_f64(-1.5);
        let c_310 = T::from_f64(310.0);
        let two = T::from_f64(2.0);
        let c_420 = T::from_f64(420.0);
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c_5 = T::from_f64(-0.2749999999999999);
        let c_6 = T::from_f64(0.47631397208144133);
        let c_7 = T::from_f64(-0.27500000000000024);
        let c_8 = T::from_f64(-0.47631397208144116);
        let c_1_57 = T::from_f64(1.57);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        let capsule_w_x = capsule_wz
            .fmadd(capsule_r13, capsule_wy.fmadd(capsule_r12, capsule_wx * capsule_r11));
        let capsule_w_y = capsule_wz
            .fmadd(capsule_r23, capsule_wy.fmadd(capsule_r22, capsule_wx * capsule_r21));
        let capsule_w_z = capsule_wz
            .fmadd(capsule_r33, capsule_wy.fmadd(capsule_r32, capsule_wx * capsule_r31));
        /// `canopy`.
        let canopy_spin_x = c_60 * canopy_wx;
        let canopy_spin_y = c_60 * canopy_wy;
        let canopy_spin_z = c_90 * canopy_wz;
        let canopy_t = half
            * c_16
                .fmadd(
                    canopy_vz
                        .fmadd(
                            canopy_vz,
                            canopy_vy.fmadd(canopy_vy, canopy_vx * canopy_vx),
                        ),
                    canopy_wz
                        .fmadd(
                            canopy_spin_z,
                            canopy_wy.fmadd(canopy_spin_y, canopy_wx * canopy_spin_x),
                        ),
                );
        let canopy_d_z = canopy_z - c;
        let canopy_t_2 = canopy_y.fmadd(canopy_y, canopy_x * canopy_x);
        let canopy_d_squared = canopy_d_z.fmadd(canopy_d_z, canopy_t_2);
        let canopy_distance = canopy_d_squared.sqrt();
        let canopy_t_3 = c_16 * (c_2 / canopy_distance)
            * (canopy_z.fmadd(canopy_z - c_3, canopy_t_2)
                / (c_4 * (canopy_distance + c_4)));
        /// `capsule`.
        let capsule_spin_x = c_m1_5.fmadd(capsule_wy, c_300 * capsule_wx);
        let capsule_spin_y = two
            .fmadd(capsule_wz, c_310.fmadd(capsule_wy, c_m1_5 * capsule_wx));
        let capsule_spin_z = c_420.fmadd(capsule_wz, two * capsule_wy);
        let kinetic = half
            .fmadd(
                m_cap
                    .fmadd(
                        capsule_vz
                            .fmadd(
                                capsule_vz,
                                capsule_vy.fmadd(capsule_vy, capsule_vx * capsule_vx),
                            ),
                        capsule_wz
                            .fmadd(
                                capsule_spin_z,
                                capsule_wy
                                    .fmadd(capsule_spin_y, capsule_wx * capsule_spin_x),
                            ),
                    ),
                canopy_t,
            );
        let capsule_d_z = capsule_z - c;
        let capsule_t = capsule_y.fmadd(capsule_y, capsule_x * capsule_x);
        let capsule_d_squared = capsule_d_z.fmadd(capsule_d_z, capsule_t);
        let capsule_distance = capsule_d_squared.sqrt();
        let gravitational = (m_cap * (c_2 / capsule_distance))
            .fmadd(
                capsule_z.fmadd(capsule_z - c_3, capsule_t)
                    / (c_4 * (capsule_distance + c_4)),
                canopy_t_3,
            );
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        let riser_t_2 = riser_stretch.max(zero);
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t - c_2_1;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t_2 = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t_2, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t_2, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t_2, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        let leg_0_rate = leg_0_u_z
            .fmadd(
                confluence_wz - leg_0_v_z,
                leg_0_u_y
                    .fmadd(
                        confluence_wy - leg_0_v_y,
                        leg_0_u_x * (confluence_wx - leg_0_v_x),
                    ),
            );
        let leg_0_pull = c_470.fmadd(leg_0_rate, c_47000 * leg_0_stretch);
        let leg_0_tension = T::select(
            zero.lt(leg_0_hold),
            leg_0_pull,
            T::select(
                leg_0_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_0_stretch), leg_0_pull.max(zero), zero),
            ),
        );
        let leg_0_t_3 = leg_0_stretch.max(zero);
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_6.fmadd(capsule_r12, c_5 * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_6.fmadd(capsule_r22, c_5 * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_6.fmadd(capsule_r32, c_5 * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t - c_2_1;
        let leg_1_t_2 = c_6.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_3 = c_1_23.fnmadd(capsule_wx, c_5 * capsule_wz);
        let leg_1_t_4 = c_5.fnmadd(capsule_wy, c_6 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_4, capsule_r12.fmadd(leg_1_t_3, capsule_r11 * leg_1_t_2));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_4, capsule_r22.fmadd(leg_1_t_3, capsule_r21 * leg_1_t_2));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_4, capsule_r32.fmadd(leg_1_t_3, capsule_r31 * leg_1_t_2));
        let leg_1_rate = leg_1_u_z
            .fmadd(
                confluence_wz - leg_1_v_z,
                leg_1_u_y
                    .fmadd(
                        confluence_wy - leg_1_v_y,
                        leg_1_u_x * (confluence_wx - leg_1_v_x),
                    ),
            );
        let leg_1_pull = c_470.fmadd(leg_1_rate, c_47000 * leg_1_stretch);
        let leg_1_tension = T::select(
            zero.lt(leg_1_hold),
            leg_1_pull,
            T::select(
                leg_1_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_1_stretch), leg_1_pull.max(zero), zero),
            ),
        );
        let leg_1_t_5 = leg_1_stretch.max(zero);
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_8.fmadd(capsule_r12, c_7 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_8.fmadd(capsule_r22, c_7 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_8.fmadd(capsule_r32, c_7 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t - c_2_1;
        let leg_2_t_2 = c_8.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_3 = c_1_23.fnmadd(capsule_wx, c_7 * capsule_wz);
        let leg_2_t_4 = c_7.fnmadd(capsule_wy, c_8 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_4, capsule_r12.fmadd(leg_2_t_3, capsule_r11 * leg_2_t_2));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_4, capsule_r22.fmadd(leg_2_t_3, capsule_r21 * leg_2_t_2));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_4, capsule_r32.fmadd(leg_2_t_3, capsule_r31 * leg_2_t_2));
        let leg_2_rate = leg_2_u_z
            .fmadd(
                confluence_wz - leg_2_v_z,
                leg_2_u_y
                    .fmadd(
                        confluence_wy - leg_2_v_y,
                        leg_2_u_x * (confluence_wx - leg_2_v_x),
                    ),
            );
        let leg_2_pull = c_470.fmadd(leg_2_rate, c_47000 * leg_2_stretch);
        let leg_2_tension = T::select(
            zero.lt(leg_2_hold),
            leg_2_pull,
            T::select(
                leg_2_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_2_stretch), leg_2_pull.max(zero), zero),
            ),
        );
        let leg_2_t_5 = leg_2_stretch.max(zero);
        let elastic = half
            .fmadd(
                c_47000 * (leg_2_t_5 * leg_2_t_5),
                half
                    .fmadd(
                        c_47000 * (leg_1_t_5 * leg_1_t_5),
                        half
                            .fmadd(
                                c_47000 * (leg_0_t_3 * leg_0_t_3),
                                half * (riser_k * (riser_t_2 * riser_t_2)),
                            ),
                    ),
            );
        let damper_power = leg_2_rate
            .fnmadd(
                c_47000.fnmadd(leg_2_t_5, leg_2_tension.max(zero)),
                leg_1_rate
                    .fnmadd(
                        c_47000.fnmadd(leg_1_t_5, leg_1_tension.max(zero)),
                        leg_0_rate
                            .fnmadd(
                                c_47000.fnmadd(leg_0_t_3, leg_0_tension.max(zero)),
                                riser_rate
                                    * riser_k.fmsub(riser_t_2, riser_tension.max(zero)),
                            ),
                    ),
            );
        let leg_2_scaled_canopy_wy = c_1_57 * canopy_wy;
        let leg_2_scaled_canopy_wx = c_1_57 * canopy_wx;
        let leg_2_v_x_2 = canopy_vx
            + canopy_r12
                .fnmadd(leg_2_scaled_canopy_wx, canopy_r11 * leg_2_scaled_canopy_wy);
        let leg_2_v_y_2 = canopy_vy
            + canopy_r22
                .fnmadd(leg_2_scaled_canopy_wx, canopy_r21 * leg_2_scaled_canopy_wy);
        let leg_2_v_z_2 = canopy_vz
            + canopy_r32
                .fnmadd(leg_2_scaled_canopy_wx, canopy_r31 * leg_2_scaled_canopy_wy);
        /// `drag`: load.
        let drag_t = leg_2_v_x_2 - wind_x;
        let drag_t_2 = leg_2_v_y_2 - wind_y;
        let drag_t_3 = leg_2_v_z_2 - wind_z;
        let drag_t_4 = derived_1
            * drag_t_3.fmadd(drag_t_3, drag_t_2.fmadd(drag_t_2, drag_t * drag_t)).sqrt();
        let thruster_t = thruster_couple_z
            .fmadd(
                capsule_w_z,
                thruster_couple_y.fmadd(capsule_w_y, thruster_couple_x * capsule_w_x),
            );
        let load_power = leg_2_v_z_2
            .fmadd(
                drag_t_3 * drag_t_4,
                leg_2_v_y_2.fmadd(drag_t_2 * drag_t_4, leg_2_v_x_2 * (drag_t * drag_t_4)),
            )
            + capsule_vz
                .fmadd(thruster_z, capsule_vy.fmadd(thruster_y, capsule_vx * thruster_x))
            + thruster_t;
        *out = [kinetic, gravitational, elastic, load_power, damper_power, zero];
    }
    /// Mass matrix `M` in `M v̇ + h = f`.
    /// 12×12 [kg, kg m²], row by row, structural non-zeros only.
    /// 0 operations (0 additions, 0 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections).
    #[inline(never)]
    fn mass_matrix<T: ::mbd_runtime::Real>(params: &[T; 3], out: &mut [T; 144]) {
        let [_, m_cap, _] = *params;
        let c_16 = T::from_f64(16.0);
        let c_60 = T::from_f64(60.0);
        let c_90 = T::from_f64(90.0);
        let c_300 = T::from_f64(300.0);
        let c_m1_5 = T::from_f64(-1.5);
        let c_310 = T::from_f64(310.0);
        let two = T::from_f64(2.0);
        let c_420 = T::from_f64(420.0);
        out[0] = c_16;
        out[13] = c_16;
        out[26] = c_16;
        out[39] = c_60;
        out[52] = c_60;
        out[65] = c_90;
        out[78] = m_cap;
        out[91] = m_cap;
        out[104] = m_cap;
        out[117] = c_300;
        out[118] = c_m1_5;
        out[129] = c_m1_5;
        out[130] = c_310;
        out[131] = two;
        out[142] = two;
        out[143] = c_420;
    }
    /// Bias force `h` in `M v̇ + h = f`: velocity terms and gravity.
    /// 12 [N, N m].
    /// 58 operations (13 additions, 41 multiplications, 2 divisions, 2 roots, 0 trigonometric, 0 selections).
    #[inline(never)]
    fn bias_force<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        params: &[T; 3],
        out: &mut [T; 12],
    ) {
        let [canopy_x, canopy_y, canopy_z, _, _, _, _, capsule_x, capsule_y, capsule_z,
        _, _, _, _] = *q;
        let [_, _, _, canopy_wx, canopy_wy, canopy_wz, _, _, _, capsule_wx, capsule_wy,
        capsule_wz] = *v;
        let [_, m_cap, _] = *params;
        let c = T::from_f64(-3404590.0);
        let one = T::from_f64(1.0);
        let c_2 = T::from_f64(4.2828e13);
        let c_16 = T::from_f64(16.0);
        let c_30 = T::from_f64(30.0);
        let c_m30 = T::from_f64(-30.0);
        let c_300 = T::from_f64(300.0);
        let c_m1_5 = T::from_f64(-1.5);
        let c_310 = T::from_f64(310.0);
        let two = T::from_f64(2.0);
        let c_420 = T::from_f64(420.0);
        let zero = T::from_f64(0.0);
        /// `canopy`: where it is, how it moves.
        let canopy_d_z = canopy_z - c;
        let canopy_d_squared = canopy_d_z
            .fmadd(canopy_d_z, canopy_y.fmadd(canopy_y, canopy_x * canopy_x));
        let canopy_distance = canopy_d_squared.sqrt();
        let canopy_inverse = one / canopy_distance;
        let canopy_gravity = canopy_inverse * (canopy_inverse * (c_2 * canopy_inverse));
        let canopy_vx_bias = canopy_x * canopy_gravity * c_16;
        let canopy_vy_bias = canopy_y * canopy_gravity * c_16;
        let canopy_vz_bias = canopy_d_z * canopy_gravity * c_16;
        let canopy_gyro_x = c_30 * (canopy_wy * canopy_wz);
        let canopy_gyro_y = c_m30 * (canopy_wx * canopy_wz);
        /// `capsule`: where it is, how it moves.
        let capsule_d_z = capsule_z - c;
        let capsule_d_squared = capsule_d_z
            .fmadd(capsule_d_z, capsule_y.fmadd(capsule_y, capsule_x * capsule_x));
        let capsule_distance = capsule_d_squared.sqrt();
        let capsule_inverse = one / capsule_distance;
        let capsule_gravity = capsule_inverse
            * (capsule_inverse * (c_2 * capsule_inverse));
        let capsule_vx_bias = m_cap * (capsule_x * capsule_gravity);
        let capsule_vy_bias = m_cap * (capsule_y * capsule_gravity);
        let capsule_vz_bias = m_cap * (capsule_d_z * capsule_gravity);
        let capsule_spin_x = c_m1_5.fmadd(capsule_wy, c_300 * capsule_wx);
        let capsule_spin_y = two
            .fmadd(capsule_wz, c_310.fmadd(capsule_wy, c_m1_5 * capsule_wx));
        let capsule_spin_z = c_420.fmadd(capsule_wz, two * capsule_wy);
        let capsule_gyro_x = capsule_wz
            .fnmadd(capsule_spin_y, capsule_wy * capsule_spin_z);
        let capsule_gyro_y = capsule_wx
            .fnmadd(capsule_spin_z, capsule_wz * capsule_spin_x);
        let capsule_gyro_z = capsule_wy
            .fnmadd(capsule_spin_x, capsule_wx * capsule_spin_y);
        *out = [
            canopy_vx_bias,
            canopy_vy_bias,
            canopy_vz_bias,
            canopy_gyro_x,
            canopy_gyro_y,
            zero,
            capsule_vx_bias,
            capsule_vy_bias,
            capsule_vz_bias,
            capsule_gyro_x,
            capsule_gyro_y,
            capsule_gyro_z,
        ];
    }
    /// Applied forces `f` in `M v̇ + h = f`: lines and loads.
    /// 12 [N, N m], about the centres of mass.
    /// 460 operations (209 additions, 210 multiplications, 4 divisions, 5 roots, 0 trigonometric, 32 selections).
    #[inline(never)]
    fn forces<T: ::mbd_runtime::Real>(
        q: &[T; 14],
        v: &[T; 12],
        z: &[T; 3],
        nodes: &[T; 3],
        hold: &[T; 4],
        inputs: &[T; 9],
        params: &[T; 3],
        derived: &[T; 2],
        out: &mut [T; 12],
    ) {
        let [canopy_x, canopy_y, canopy_z, canopy_qw, canopy_qx, canopy_qy, canopy_qz,
        capsule_x, capsule_y, capsule_z, capsule_qw, capsule_qx, capsule_qy, capsule_qz,
        ] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, _, capsule_vx,
        capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let [confluence_x, confluence_y, confluence_z] = *z;
        let [confluence_wx, confluence_wy, confluence_wz] = *nodes;
        let [riser_hold, leg_0_hold, leg_1_hold, leg_2_hold] = *hold;
        let [wind_x, wind_y, wind_z, thruster_x, thruster_y, thruster_z,
        thruster_couple_x, thruster_couple_y, thruster_couple_z] = *inputs;
        let [riser_k, _, _] = *params;
        let [_, derived_1] = *derived;
        let c_m9_5 = T::from_f64(-9.5);
        let tiny = T::from_f64(1e-18);
        let one = T::from_f64(1.0);
        let c_10 = T::from_f64(10.0);
        let c_600 = T::from_f64(600.0);
        let zero = T::from_f64(0.0);
        let c_0_55 = T::from_f64(0.55);
        let c_1_23 = T::from_f64(1.23);
        let c_2_1 = T::from_f64(2.1);
        let c_47000 = T::from_f64(47000.0);
        let c_470 = T::from_f64(470.0);
        let c = T::from_f64(-0.2749999999999999);
        let c_2 = T::from_f64(0.47631397208144133);
        let c_3 = T::from_f64(-0.27500000000000024);
        let c_4 = T::from_f64(-0.47631397208144116);
        let c_1_57 = T::from_f64(1.57);
        /// `canopy`: where it is, how it moves.
        let canopy_q_ww = canopy_qw * canopy_qw;
        let canopy_q_xx = canopy_qx * canopy_qx;
        let canopy_q_yy = canopy_qy * canopy_qy;
        let canopy_q_zz = canopy_qz * canopy_qz;
        let canopy_twice_qx = canopy_qx + canopy_qx;
        let canopy_twice_qy = canopy_qy + canopy_qy;
        let canopy_twice_q_xy = canopy_qy * canopy_twice_qx;
        let canopy_twice_q_xz = canopy_qz * canopy_twice_qx;
        let canopy_twice_q_yz = canopy_qz * canopy_twice_qy;
        let canopy_twice_q_wx = canopy_qw * canopy_twice_qx;
        let canopy_twice_q_wy = canopy_qw * canopy_twice_qy;
        let canopy_twice_q_wz = canopy_qw * (canopy_qz + canopy_qz);
        let canopy_q_ww_minus_q_xx = canopy_q_ww - canopy_q_xx;
        let canopy_q_yy_minus_q_zz = canopy_q_yy - canopy_q_zz;
        let canopy_r11 = canopy_q_ww + canopy_q_xx - (canopy_q_yy + canopy_q_zz);
        let canopy_r12 = canopy_twice_q_xy - canopy_twice_q_wz;
        let canopy_r13 = canopy_twice_q_xz + canopy_twice_q_wy;
        let canopy_r21 = canopy_twice_q_xy + canopy_twice_q_wz;
        let canopy_r22 = canopy_q_ww_minus_q_xx + canopy_q_yy_minus_q_zz;
        let canopy_r23 = canopy_twice_q_yz - canopy_twice_q_wx;
        let canopy_r31 = canopy_twice_q_xz - canopy_twice_q_wy;
        let canopy_r32 = canopy_twice_q_yz + canopy_twice_q_wx;
        let canopy_r33 = canopy_q_ww_minus_q_xx - canopy_q_yy_minus_q_zz;
        /// `capsule`: where it is, how it moves.
        let capsule_q_ww = capsule_qw * capsule_qw;
        let capsule_q_xx = capsule_qx * capsule_qx;
        let capsule_q_yy = capsule_qy * capsule_qy;
        let capsule_q_zz = capsule_qz * capsule_qz;
        let capsule_twice_qx = capsule_qx + capsule_qx;
        let capsule_twice_qy = capsule_qy + capsule_qy;
        let capsule_twice_q_xy = capsule_qy * capsule_twice_qx;
        let capsule_twice_q_xz = capsule_qz * capsule_twice_qx;
        let capsule_twice_q_yz = capsule_qz * capsule_twice_qy;
        let capsule_twice_q_wx = capsule_qw * capsule_twice_qx;
        let capsule_twice_q_wy = capsule_qw * capsule_twice_qy;
        let capsule_twice_q_wz = capsule_qw * (capsule_qz + capsule_qz);
        let capsule_q_ww_minus_q_xx = capsule_q_ww - capsule_q_xx;
        let capsule_q_yy_minus_q_zz = capsule_q_yy - capsule_q_zz;
        let capsule_r11 = capsule_q_ww + capsule_q_xx - (capsule_q_yy + capsule_q_zz);
        let capsule_r12 = capsule_twice_q_xy - capsule_twice_q_wz;
        let capsule_r13 = capsule_twice_q_xz + capsule_twice_q_wy;
        let capsule_r21 = capsule_twice_q_xy + capsule_twice_q_wz;
        let capsule_r22 = capsule_q_ww_minus_q_xx + capsule_q_yy_minus_q_zz;
        let capsule_r23 = capsule_twice_q_yz - capsule_twice_q_wx;
        let capsule_r31 = capsule_twice_q_xz - capsule_twice_q_wy;
        let capsule_r32 = capsule_twice_q_yz + capsule_twice_q_wx;
        let capsule_r33 = capsule_q_ww_minus_q_xx - capsule_q_yy_minus_q_zz;
        /// `riser`: length and tension.
        let riser_arm_x = c_m9_5 * canopy_r13;
        let riser_arm_y = c_m9_5 * canopy_r23;
        let riser_arm_z = c_m9_5 * canopy_r33;
        let riser_p_x = canopy_x + riser_arm_x;
        let riser_p_y = canopy_y + riser_arm_y;
        let riser_p_z = canopy_z + riser_arm_z;
        let riser_e_x = confluence_x - riser_p_x;
        let riser_e_y = confluence_y - riser_p_y;
        let riser_e_z = confluence_z - riser_p_z;
        let riser_length = riser_e_z
            .fmadd(riser_e_z, riser_e_y.fmadd(riser_e_y, riser_e_x * riser_e_x))
            .sqrt();
        let riser_t = riser_length.max(tiny);
        let riser_inverse_length = one / riser_t;
        let riser_u_x = riser_e_x * riser_inverse_length;
        let riser_u_y = riser_e_y * riser_inverse_length;
        let riser_u_z = riser_e_z * riser_inverse_length;
        let riser_stretch = riser_t - c_10;
        let riser_scaled_canopy_wy = c_m9_5 * canopy_wy;
        let riser_scaled_canopy_wx = c_m9_5 * canopy_wx;
        let riser_v_x = canopy_vx
            + canopy_r12
                .fnmadd(riser_scaled_canopy_wx, canopy_r11 * riser_scaled_canopy_wy);
        let riser_v_y = canopy_vy
            + canopy_r22
                .fnmadd(riser_scaled_canopy_wx, canopy_r21 * riser_scaled_canopy_wy);
        let riser_v_z = canopy_vz
            + canopy_r32
                .fnmadd(riser_scaled_canopy_wx, canopy_r31 * riser_scaled_canopy_wy);
        let riser_rate = riser_u_z
            .fmadd(
                confluence_wz - riser_v_z,
                riser_u_y
                    .fmadd(
                        confluence_wy - riser_v_y,
                        riser_u_x * (confluence_wx - riser_v_x),
                    ),
            );
        let riser_pull = c_600.fmadd(riser_rate, riser_k * riser_stretch);
        let riser_tension = T::select(
            zero.lt(riser_hold),
            riser_pull,
            T::select(
                riser_hold.lt(zero),
                zero,
                T::select(zero.lt(riser_stretch), riser_pull.max(zero), zero),
            ),
        );
        let riser_force_x = riser_u_x * riser_tension;
        let riser_force_y = riser_u_y * riser_tension;
        let riser_force_z = riser_u_z * riser_tension;
        /// `leg[0]`: length and tension.
        let leg_0_arm_x = c_1_23.fmadd(capsule_r13, c_0_55 * capsule_r11);
        let leg_0_arm_y = c_1_23.fmadd(capsule_r23, c_0_55 * capsule_r21);
        let leg_0_arm_z = c_1_23.fmadd(capsule_r33, c_0_55 * capsule_r31);
        let leg_0_p_x = capsule_x + leg_0_arm_x;
        let leg_0_p_y = capsule_y + leg_0_arm_y;
        let leg_0_p_z = capsule_z + leg_0_arm_z;
        let leg_0_e_x = confluence_x - leg_0_p_x;
        let leg_0_e_y = confluence_y - leg_0_p_y;
        let leg_0_e_z = confluence_z - leg_0_p_z;
        let leg_0_length = leg_0_e_z
            .fmadd(leg_0_e_z, leg_0_e_y.fmadd(leg_0_e_y, leg_0_e_x * leg_0_e_x))
            .sqrt();
        let leg_0_t = leg_0_length.max(tiny);
        let leg_0_inverse_length = one / leg_0_t;
        let leg_0_u_x = leg_0_e_x * leg_0_inverse_length;
        let leg_0_u_y = leg_0_e_y * leg_0_inverse_length;
        let leg_0_u_z = leg_0_e_z * leg_0_inverse_length;
        let leg_0_stretch = leg_0_t - c_2_1;
        let leg_0_scaled_capsule_wy = c_1_23 * capsule_wy;
        let leg_0_t_2 = c_1_23.fnmadd(capsule_wx, c_0_55 * capsule_wz);
        let leg_0_scaled_capsule_wy_2 = c_0_55 * capsule_wy;
        let leg_0_v_x = capsule_vx
            + capsule_r13
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r12.fmadd(leg_0_t_2, capsule_r11 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_y = capsule_vy
            + capsule_r23
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r22.fmadd(leg_0_t_2, capsule_r21 * leg_0_scaled_capsule_wy),
                );
        let leg_0_v_z = capsule_vz
            + capsule_r33
                .fnmadd(
                    leg_0_scaled_capsule_wy_2,
                    capsule_r32.fmadd(leg_0_t_2, capsule_r31 * leg_0_scaled_capsule_wy),
                );
        let leg_0_rate = leg_0_u_z
            .fmadd(
                confluence_wz - leg_0_v_z,
                leg_0_u_y
                    .fmadd(
                        confluence_wy - leg_0_v_y,
                        leg_0_u_x * (confluence_wx - leg_0_v_x),
                    ),
            );
        let leg_0_pull = c_470.fmadd(leg_0_rate, c_47000 * leg_0_stretch);
        let leg_0_tension = T::select(
            zero.lt(leg_0_hold),
            leg_0_pull,
            T::select(
                leg_0_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_0_stretch), leg_0_pull.max(zero), zero),
            ),
        );
        let leg_0_force_x = leg_0_u_x * leg_0_tension;
        let leg_0_force_y = leg_0_u_y * leg_0_tension;
        let leg_0_force_z = leg_0_u_z * leg_0_tension;
        /// `leg[1]`: length and tension.
        let leg_1_arm_x = c_1_23
            .fmadd(capsule_r13, c_2.fmadd(capsule_r12, c * capsule_r11));
        let leg_1_arm_y = c_1_23
            .fmadd(capsule_r23, c_2.fmadd(capsule_r22, c * capsule_r21));
        let leg_1_arm_z = c_1_23
            .fmadd(capsule_r33, c_2.fmadd(capsule_r32, c * capsule_r31));
        let leg_1_p_x = capsule_x + leg_1_arm_x;
        let leg_1_p_y = capsule_y + leg_1_arm_y;
        let leg_1_p_z = capsule_z + leg_1_arm_z;
        let leg_1_e_x = confluence_x - leg_1_p_x;
        let leg_1_e_y = confluence_y - leg_1_p_y;
        let leg_1_e_z = confluence_z - leg_1_p_z;
        let leg_1_length = leg_1_e_z
            .fmadd(leg_1_e_z, leg_1_e_y.fmadd(leg_1_e_y, leg_1_e_x * leg_1_e_x))
            .sqrt();
        let leg_1_t = leg_1_length.max(tiny);
        let leg_1_inverse_length = one / leg_1_t;
        let leg_1_u_x = leg_1_e_x * leg_1_inverse_length;
        let leg_1_u_y = leg_1_e_y * leg_1_inverse_length;
        let leg_1_u_z = leg_1_e_z * leg_1_inverse_length;
        let leg_1_stretch = leg_1_t - c_2_1;
        let leg_1_t_2 = c_2.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_1_t_3 = c_1_23.fnmadd(capsule_wx, c * capsule_wz);
        let leg_1_t_4 = c.fnmadd(capsule_wy, c_2 * capsule_wx);
        let leg_1_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_1_t_4, capsule_r12.fmadd(leg_1_t_3, capsule_r11 * leg_1_t_2));
        let leg_1_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_1_t_4, capsule_r22.fmadd(leg_1_t_3, capsule_r21 * leg_1_t_2));
        let leg_1_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_1_t_4, capsule_r32.fmadd(leg_1_t_3, capsule_r31 * leg_1_t_2));
        let leg_1_rate = leg_1_u_z
            .fmadd(
                confluence_wz - leg_1_v_z,
                leg_1_u_y
                    .fmadd(
                        confluence_wy - leg_1_v_y,
                        leg_1_u_x * (confluence_wx - leg_1_v_x),
                    ),
            );
        let leg_1_pull = c_470.fmadd(leg_1_rate, c_47000 * leg_1_stretch);
        let leg_1_tension = T::select(
            zero.lt(leg_1_hold),
            leg_1_pull,
            T::select(
                leg_1_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_1_stretch), leg_1_pull.max(zero), zero),
            ),
        );
        let leg_1_force_x = leg_1_u_x * leg_1_tension;
        let leg_1_force_y = leg_1_u_y * leg_1_tension;
        let leg_1_force_z = leg_1_u_z * leg_1_tension;
        /// `leg[2]`: length and tension.
        let leg_2_arm_x = c_1_23
            .fmadd(capsule_r13, c_4.fmadd(capsule_r12, c_3 * capsule_r11));
        let leg_2_arm_y = c_1_23
            .fmadd(capsule_r23, c_4.fmadd(capsule_r22, c_3 * capsule_r21));
        let leg_2_arm_z = c_1_23
            .fmadd(capsule_r33, c_4.fmadd(capsule_r32, c_3 * capsule_r31));
        let leg_2_p_x = capsule_x + leg_2_arm_x;
        let leg_2_p_y = capsule_y + leg_2_arm_y;
        let leg_2_p_z = capsule_z + leg_2_arm_z;
        let leg_2_e_x = confluence_x - leg_2_p_x;
        let leg_2_e_y = confluence_y - leg_2_p_y;
        let leg_2_e_z = confluence_z - leg_2_p_z;
        let leg_2_length = leg_2_e_z
            .fmadd(leg_2_e_z, leg_2_e_y.fmadd(leg_2_e_y, leg_2_e_x * leg_2_e_x))
            .sqrt();
        let leg_2_t = leg_2_length.max(tiny);
        let leg_2_inverse_length = one / leg_2_t;
        let leg_2_u_x = leg_2_e_x * leg_2_inverse_length;
        let leg_2_u_y = leg_2_e_y * leg_2_inverse_length;
        let leg_2_u_z = leg_2_e_z * leg_2_inverse_length;
        let leg_2_stretch = leg_2_t - c_2_1;
        let leg_2_t_2 = c_4.fnmadd(capsule_wz, leg_0_scaled_capsule_wy);
        let leg_2_t_3 = c_1_23.fnmadd(capsule_wx, c_3 * capsule_wz);
        let leg_2_t_4 = c_3.fnmadd(capsule_wy, c_4 * capsule_wx);
        let leg_2_v_x = capsule_vx
            + capsule_r13
                .fmadd(leg_2_t_4, capsule_r12.fmadd(leg_2_t_3, capsule_r11 * leg_2_t_2));
        let leg_2_v_y = capsule_vy
            + capsule_r23
                .fmadd(leg_2_t_4, capsule_r22.fmadd(leg_2_t_3, capsule_r21 * leg_2_t_2));
        let leg_2_v_z = capsule_vz
            + capsule_r33
                .fmadd(leg_2_t_4, capsule_r32.fmadd(leg_2_t_3, capsule_r31 * leg_2_t_2));
        let leg_2_rate = leg_2_u_z
            .fmadd(
                confluence_wz - leg_2_v_z,
                leg_2_u_y
                    .fmadd(
                        confluence_wy - leg_2_v_y,
                        leg_2_u_x * (confluence_wx - leg_2_v_x),
                    ),
            );
        let leg_2_pull = c_470.fmadd(leg_2_rate, c_47000 * leg_2_stretch);
        let leg_2_tension = T::select(
            zero.lt(leg_2_hold),
            leg_2_pull,
            T::select(
                leg_2_hold.lt(zero),
                zero,
                T::select(zero.lt(leg_2_stretch), leg_2_pull.max(zero), zero),
            ),
        );
        let leg_2_force_x = leg_2_u_x * leg_2_tension;
        let leg_2_force_y = leg_2_u_y * leg_2_tension;
        let leg_2_force_z = leg_2_u_z * leg_2_tension;
        /// `drag`: load.
        let drag_scaled_canopy_wy = c_1_57 * canopy_wy;
        let drag_scaled_canopy_wx = c_1_57 * canopy_wx;
        let drag_v_x = canopy_vx
            + canopy_r12
                .fnmadd(drag_scaled_canopy_wx, canopy_r11 * drag_scaled_canopy_wy);
        let drag_v_y = canopy_vy
            + canopy_r22
                .fnmadd(drag_scaled_canopy_wx, canopy_r21 * drag_scaled_canopy_wy);
        let drag_v_z = canopy_vz
            + canopy_r32
                .fnmadd(drag_scaled_canopy_wx, canopy_r31 * drag_scaled_canopy_wy);
        let drag_v_x_minus_wind_x = drag_v_x - wind_x;
        let drag_v_y_minus_wind_y = drag_v_y - wind_y;
        let drag_v_z_minus_wind_z = drag_v_z - wind_z;
        let drag_t = derived_1
            * drag_v_z_minus_wind_z
                .fmadd(
                    drag_v_z_minus_wind_z,
                    drag_v_y_minus_wind_y
                        .fmadd(
                            drag_v_y_minus_wind_y,
                            drag_v_x_minus_wind_x * drag_v_x_minus_wind_x,
                        ),
                )
                .sqrt();
        let drag_t_2 = drag_v_x_minus_wind_x * drag_t;
        let drag_t_3 = drag_v_y_minus_wind_y * drag_t;
        let drag_t_4 = drag_v_z_minus_wind_z * drag_t;
        let drag_arm_x = c_1_57 * canopy_r13;
        let drag_arm_y = c_1_57 * canopy_r23;
        let drag_arm_z = c_1_57 * canopy_r33;
        let canopy_vx_force = drag_v_x_minus_wind_x.fmadd(drag_t, riser_force_x);
        let canopy_vy_force = drag_v_y_minus_wind_y.fmadd(drag_t, riser_force_y);
        let canopy_vz_force = drag_v_z_minus_wind_z.fmadd(drag_t, riser_force_z);
        let drag_t_5 = riser_arm_z.fnmadd(riser_force_y, riser_arm_y * riser_force_z)
            + drag_t_3.fnmadd(drag_arm_z, drag_t_4 * drag_arm_y);
        let drag_t_6 = riser_arm_x.fnmadd(riser_force_z, riser_arm_z * riser_force_x)
            + drag_t_4.fnmadd(drag_arm_x, drag_t_2 * drag_arm_z);
        let drag_t_7 = riser_arm_y.fnmadd(riser_force_x, riser_arm_x * riser_force_y)
            + drag_t_2.fnmadd(drag_arm_y, drag_t_3 * drag_arm_x);
        /// `thruster`: load.
        let capsule_vx_force = thruster_x
            + (leg_0_force_x + leg_1_force_x + leg_2_force_x);
        let capsule_vy_force = thruster_y
            + (leg_0_force_y + leg_1_force_y + leg_2_force_y);
        let capsule_vz_force = thruster_z
            + (leg_0_force_z + leg_1_force_z + leg_2_force_z);
        let thruster_t = thruster_couple_x
            + (leg_0_arm_z.fnmadd(leg_0_force_y, leg_0_arm_y * leg_0_force_z)
                + leg_1_arm_z.fnmadd(leg_1_force_y, leg_1_arm_y * leg_1_force_z)
                + leg_2_arm_z.fnmadd(leg_2_force_y, leg_2_arm_y * leg_2_force_z));
        let thruster_t_2 = thruster_couple_y
            + (leg_0_arm_x.fnmadd(leg_0_force_z, leg_0_arm_z * leg_0_force_x)
                + leg_1_arm_x.fnmadd(leg_1_force_z, leg_1_arm_z * leg_1_force_x)
                + leg_2_arm_x.fnmadd(leg_2_force_z, leg_2_arm_z * leg_2_force_x));
        let thruster_t_3 = thruster_couple_z
            + (leg_0_arm_y.fnmadd(leg_0_force_x, leg_0_arm_x * leg_0_force_y)
                + leg_1_arm_y.fnmadd(leg_1_force_x, leg_1_arm_x * leg_1_force_y)
                + leg_2_arm_y.fnmadd(leg_2_force_x, leg_2_arm_x * leg_2_force_y));
        let canopy_torque_x = canopy_r31
            .fmadd(drag_t_7, canopy_r21.fmadd(drag_t_6, canopy_r11 * drag_t_5));
        let canopy_torque_y = canopy_r32
            .fmadd(drag_t_7, canopy_r22.fmadd(drag_t_6, canopy_r12 * drag_t_5));
        let canopy_torque_z = canopy_r33
            .fmadd(drag_t_7, canopy_r23.fmadd(drag_t_6, canopy_r13 * drag_t_5));
        let capsule_torque_x = capsule_r31
            .fmadd(
                thruster_t_3,
                capsule_r21.fmadd(thruster_t_2, capsule_r11 * thruster_t),
            );
        let capsule_torque_y = capsule_r32
            .fmadd(
                thruster_t_3,
                capsule_r22.fmadd(thruster_t_2, capsule_r12 * thruster_t),
            );
        let capsule_torque_z = capsule_r33
            .fmadd(
                thruster_t_3,
                capsule_r23.fmadd(thruster_t_2, capsule_r13 * thruster_t),
            );
        *out = [
            canopy_vx_force,
            canopy_vy_force,
            canopy_vz_force,
            canopy_torque_x,
            canopy_torque_y,
            canopy_torque_z,
            capsule_vx_force,
            capsule_vy_force,
            capsule_vz_force,
            capsule_torque_x,
            capsule_torque_y,
            capsule_torque_z,
        ];
    }
    /// Rates of the coordinates: `q̇ = N(q) v`.
    /// 46 operations (16 additions, 30 multiplications, 0 divisions, 0 roots, 0 trigonometric, 0 selections).
    #[inline(never)]
    fn kinematics<T: ::mbd_runtime::Real>(q: &[T; 14], v: &[T; 12], out: &mut [T; 14]) {
        let [_, _, _, canopy_qw, canopy_qx, canopy_qy, canopy_qz, _, _, _, capsule_qw,
        capsule_qx, capsule_qy, capsule_qz] = *q;
        let [canopy_vx, canopy_vy, canopy_vz, canopy_wx, canopy_wy, canopy_wz,
        capsule_vx, capsule_vy, capsule_vz, capsule_wx, capsule_wy, capsule_wz] = *v;
        let minus_half = T::from_f64(-0.5);
        /// `canopy`: where it is, how it moves.
        let canopy_wx_minus_half = canopy_wx * minus_half;
        let canopy_wy_minus_half = canopy_wy * minus_half;
        let canopy_wz_minus_half = canopy_wz * minus_half;
        let canopy_t = canopy_qz
            .fmadd(
                canopy_wz_minus_half,
                canopy_qy.fmadd(canopy_wy_minus_half, canopy_qx * canopy_wx_minus_half),
            );
        let canopy_t_2 = canopy_qw
            .fnmadd(
                canopy_wx_minus_half,
                canopy_qy.fnmadd(canopy_wz_minus_half, canopy_qz * canopy_wy_minus_half),
            );
        let canopy_t_3 = canopy_qw
            .fnmadd(
                canopy_wy_minus_half,
                canopy_qz.fnmadd(canopy_wx_minus_half, canopy_qx * canopy_wz_minus_half),
            );
        let canopy_t_4 = canopy_qw
            .fnmadd(
                canopy_wz_minus_half,
                canopy_qx.fnmadd(canopy_wy_minus_half, canopy_qy * canopy_wx_minus_half),
            );
        /// `capsule`: where it is, how it moves.
        let capsule_wx_minus_half = capsule_wx * minus_half;
        let capsule_wy_minus_half = capsule_wy * minus_half;
        let capsule_wz_minus_half = capsule_wz * minus_half;
        let capsule_t = capsule_qz
            .fmadd(
                capsule_wz_minus_half,
                capsule_qy
                    .fmadd(capsule_wy_minus_half, capsule_qx * capsule_wx_minus_half),
            );
        let capsule_t_2 = capsule_qw
            .fnmadd(
                capsule_wx_minus_half,
                capsule_qy
                    .fnmadd(capsule_wz_minus_half, capsule_qz * capsule_wy_minus_half),
            );
        let capsule_t_3 = capsule_qw
            .fnmadd(
                capsule_wy_minus_half,
                capsule_qz
                    .fnmadd(capsule_wx_minus_half, capsule_qx * capsule_wz_minus_half),
            );
        let capsule_t_4 = capsule_qw
            .fnmadd(
                capsule_wz_minus_half,
                capsule_qx
                    .fnmadd(capsule_wy_minus_half, capsule_qy * capsule_wx_minus_half),
            );
        *out = [
            canopy_vx,
            canopy_vy,
            canopy_vz,
            canopy_t,
            canopy_t_2,
            canopy_t_3,
            canopy_t_4,
            capsule_vx,
            capsule_vy,
            capsule_vz,
            capsule_t,
            capsule_t_2,
            capsule_t_3,
            capsule_t_4,
        ];
    }
    /// Terms of the parameters alone, computed once.
    #[inline(never)]
    fn derived<T: ::mbd_runtime::Real>(params: &[T; 3], out: &mut [T; 2]) {
        let [_, m_cap, cd_s] = *params;
        let one = T::from_f64(1.0);
        let c_m0_007 = T::from_f64(-0.007);
        let capsule_inverse_mass = one / m_cap;
        let drag_cd_s_scaled = cd_s * c_m0_007;
        *out = [capsule_inverse_mass, drag_cd_s_scaled];
    }
};
const _: () = {
    #[allow(dead_code, reason = "for editors")]
    fn references(params: &ParachuteParams<f64>) {
        let _ = &params.m_cap;
        let _ = &params.riser_k;
        let _ = &params.cd_s;
    }
};
