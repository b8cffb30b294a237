//! Closed spatial loop: hinge, universal, spherical and prismatic joint at arbitrary places and axes, one freedom.
//!
//! Its numbers are random on purpose: no axis is aligned, no offset vanishes, so nothing of the equations folds away. An independent tool ran
//! the same loop; `tests/reference/loops` holds its history.

mbd_runtime::model! {
    /// Closed spatial loop of hinge, universal, spherical and prismatic joint in general position, one freedom.
    pub model SpatialLoop<T> {
        gravity: [0.0, 0.0, -9.81] m/s^2;
        emit: [outputs, energy, lines, reactions, mass_matrix];
        world {
            frame hinge_in at [0.854596381358226, -0.16370253550912262, 0.20979948210376664] m
                rotated matrix(
                    [-0.5348700732101472, -0.710825888626916, 0.45677189147530417],
                    [-0.7255081985340018, 0.10928833053702047, -0.6794806212603699],
                    [0.43307257895659834, -0.694825601763627, -0.5741650672843956]
                ),
            frame prismatic_out at [
                -0.14925881270582717, -0.3597746880599382, -0.11323597396619894,
            ] m rotated matrix([-0.5126488999418983, -0.04438863284114075, 0.8574501470422967], [0.7343038229826591, 0.49487978040534986, 0.46464168829217684], [-0.44495954978111596, 0.8678269713603324, -0.2211048322360678]),
        }
        body crank {
            mass: 1.15047121386676 kg,
            inertia: full {
                xx: 0.09435547991001479,
                yy: 0.06528240580755625,
                zz: 0.0996530543896989,
                xy: 0.008517731790719343,
                xz: -0.008876354642228076,
                yz: 0.03638263647294343,
            } kg*m^2 (matrix elements),
            frame hinge_out at [0.39309755584761397, -0.15266489346675016, -0.20915575452462418] m
                rotated matrix(
                    [-0.6371080256777206, -0.3632904435337648, 0.6797892447325694],
                    [-0.08238262007439431, 0.9089996369500734, 0.40857406174929023],
                    [-0.7663592287737616, 0.20430299474475488, -0.6090597826253263]
                ),
            frame universal_in at [-0.279659449757934, 0.2776599855950223, 0.4188802316406946] m
                rotated matrix(
                    [0.00911314010550717, -0.9554947724919685, -0.29486724202247033],
                    [-0.08392838868767893, -0.29456987531781076, 0.9519372952708274],
                    [-0.9964301160892853, 0.016072594556265356, -0.08287759319938415]
                ),
        }
        body coupler {
            mass: 2.57214468106162 kg,
            inertia: full {
                xx: 0.3646133724654997,
                yy: 0.2544128429694044,
                zz: 0.4056852230560376,
                xy: 0.04524782455713646,
                xz: 0.05860184305963574,
                yz: 0.06779440996141847,
            } kg*m^2 (matrix elements),
            frame universal_out at [0.3970353326297881, 0.13202231702911346, 0.21713247642142394] m
                rotated matrix(
                    [-0.7909195341455227, -0.24988975628768975, -0.5585708551379205],
                    [0.35576334545342764, 0.554910025885368, -0.7520021976056219],
                    [0.497874213570872, -0.7934922639032966, -0.34998756347448506]
                ),
            frame spherical_in at [
                -0.5154779034057965, -0.00233023319681949, -0.25462211770426274,
            ] m rotated matrix([0.7851770516709462, 0.07173136692268238, -0.6151029251505181], [-0.44327316596694544, -0.6285062357810096, -0.6391312947415634], [-0.4324417855191163, 0.7744898466628144, -0.46169208305238363]),
        }
        body slider {
            mass: 2.1154100996882317 kg,
            inertia: full {
                xx: 0.2818477847268445,
                yy: 0.34036760533152643,
                zz: 0.3998600249079385,
                xy: 0.12874591221952036,
                xz: -0.08830068672128827,
                yz: 0.03483051739211651,
            } kg*m^2 (matrix elements),
            frame spherical_out at [0.07581105896221131, 0.2688204267783516, -0.13418132397953023] m
                rotated matrix(
                    [0.46407399726780163, 0.6218451120257259, 0.6308280127812943],
                    [0.7526021795852087, -0.6523747415134243, 0.08942681878992531],
                    [0.4671458919261495, 0.4332618761038241, -0.7707521406856532]
                ),
            frame prismatic_in at [
                -0.037452093010696866, -0.2932851903703993, 0.31784399874699787,
            ] m rotated matrix([0.6225460872399057, -0.7526673294283333, 0.21430879700447342], [0.7787819758662284, 0.6227978901274127, -0.07497614366407726], [-0.07703897278765381, 0.2135759332510663, 0.9738841396222444]),
        }
        joint hinge_joint: hinge from world.hinge_in to crank.hinge_out { axis: z }
        joint universal_joint: universal from crank.universal_in to coupler.universal_out {
            axes: [x, y],
        }
        joint spherical_joint: spherical from coupler.spherical_in to slider.spherical_out;
        joint prismatic_joint: prismatic from slider.prismatic_in to world.prismatic_out { axis: z }

        /// Way along the slider.
        output slide = prismatic_joint.slide;
        /// Angle of the crank.
        output crank_angle = hinge_joint.angle in deg;
    }
}

/// The start of the reference history.
#[must_use]
pub fn run() -> String {
    String::from(
        r#"[run]
until = "1.5 s"
tolerance = 1e-11
every = "30 ms"
instants = ["0 s", "0.3 s", "0.6 s", "0.9 s", "1.2 s"]

[run.start]
crank.x = "0.4308151331027307 m"
crank.y = "0.04120445288332279 m"
crank.z = "0.20881586820619907 m"
crank.qw = 0.6455357816882578
crank.qx = -0.733512780029392
crank.qy = 0.1550181777626334
crank.qz = 0.1456431277363805
crank.vx = "0.34826241590266704 m/s"
crank.vy = "0.7175176700309303 m/s"
crank.vz = "-0.5720704523349124 m/s"
crank.omega_body_x = "2.0009084099311805 rad/s"
crank.omega_body_y = "1.2026069588016386 rad/s"
crank.omega_body_z = "-1.792721568705167 rad/s"
coupler.x = "-0.3466855867652894 m"
coupler.y = "0.22400804884898678 m"
coupler.z = "-0.10446391447963217 m"
coupler.qw = 0.5429694255197376
coupler.qx = 0.6790783089018222
coupler.qy = 0.35291507316164383
coupler.qz = 0.345670080373062
coupler.vx = "1.5627040414651616 m/s"
coupler.vy = "1.1986626817212864 m/s"
coupler.vz = "-0.6780990642587669 m/s"
coupler.omega_body_x = "-1.1540671049035145 rad/s"
coupler.omega_body_y = "0.4461756718879012 rad/s"
coupler.omega_body_z = "-1.126546761666716 rad/s"
slider.x = "-0.5720900593447232 m"
slider.y = "-0.26442019759218843 m"
slider.z = "-0.08946776590589257 m"
slider.qw = 0.6609751758538637
slider.qx = -0.11010233935910785
slider.qy = 0.6969430597573678
slider.qz = 0.2554597095994668
slider.vx = "1.7314305476855583 m/s"
slider.vy = "0.9382409176933544 m/s"
slider.vz = "-0.4464722084367822 m/s"
slider.omega_body_x = "9.046983416141392e-31 rad/s"
slider.omega_body_y = "-1.4216225535211726e-30 rad/s"
slider.omega_body_z = "9.738792479753834e-32 rad/s"
"#,
    )
}
