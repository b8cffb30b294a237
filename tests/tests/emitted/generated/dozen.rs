//! A dozen random scenes, compiled. Written by the test beside it with `UPDATE_GOLDEN=1`; do not edit.

mbd_runtime::model! {
    pub model Random0<T> {
        angular_velocity: body;
        gravity: oblate {
            mu: 4.2828e13 m^3/s^2,
            center: [1000.0, 0.0, -3404590.0] m,
            radius: 3396190.0 m,
            j2: 0.00196,
            axis: [0.6, 0.0, 0.8],
        };
        world {
            frame anchor0 at [-3.789, 3.767, -3.149] m,
            frame anchor1 at [-1.381, -2.609, 2.172] m,
            frame anchor2 at [-2.034, 3.616, -0.828] m,
        }
        point ball0 { mass: 2.7150 kg }
        line plain0 from ball0 to world.anchor1 {
            free_length: 1.3884 m,
            stiffness: 4236.3602 N/m,
            damping: 17.1330 N*s/m,
        }
        point knot0 { equilibrium: rate }
        line leg0_0 from world.anchor2 to knot0 {
            free_length: 0.2878 m,
            stiffness: p0,
            damping: C1,
        }
        line leg0_1 from knot0 to ball0 {
            free_length: 1.1346 m,
            stiffness: 2207.3801 N/m,
            damping: 2.5048 N*s/m,
        }
        line leg0_2 from knot0 to world.anchor0 {
            free_length: C2,
            stiffness: 1296.6573 N/m,
            damping: C3,
        }
        line leg0_3 from knot0 to ball0 { free_length: C5, stiffness: p4, damping: C6 }
        point knot1 { equilibrium: static }
        line leg1_0 from knot1 to world.anchor1 { free_length: 0.6656 m, stiffness: 913.1330 N/m }
        line leg1_1 from world.anchor0 to knot1 { free_length: p8, stiffness: p7 }
        line leg1_2 from knot1 to world.anchor1 { free_length: 1.7214 m, stiffness: C9 }
        point twin1 { equilibrium: static }
        line tie1 from knot1 to twin1 { free_length: p10, stiffness: 1452.5536 N/m }
        line twig1_0 from twin1 to ball0 { free_length: 0.3914 m, stiffness: 3898.9602 N/m }
        line twig1_1 from twin1 to world.anchor1 { free_length: 1.0437 m, stiffness: p11 }
        param p0 = 4720.7655 N/m in 2360.3827 N/m ..= 9441.5310 N/m;
        const C1 = 41.2585 N*s/m;
        const C2 = 1.0386 m;
        const C3 = 44.6151 N*s/m;
        param p4 = 3953.4543 N/m in 1976.7271 N/m ..= 7906.9085 N/m;
        const C5 = 0.5385 m;
        const C6 = 47.8268 N*s/m;
        param p7 = 4665.7718 N/m in 2332.8859 N/m ..= 9331.5436 N/m;
        param p8 = 0.8525 m in 0.4263 m ..= 1.7051 m;
        const C9 = 887.5621 N/m;
        param p10 = 0.6860 m in 0.3430 m ..= 1.3720 m;
        param p11 = 4270.0238 N/m in 2135.0119 N/m ..= 8540.0476 N/m;
    }
}

mbd_runtime::model! {
    pub model Random1<T> {
        angular_velocity: world;
        gravity: [0.3, -0.2, -9.81] m/s^2;
        body link0 {
            mass: p0,
            inertia: full {
                xx: 2.444,
                yy: 2.763,
                zz: 2.877,
                xy: -0.086,
                xz: 0.118,
                yz: -0.038,
            } kg*m^2 (matrix elements),
            frame f0 at [0.211, -0.090, 0.060] m,
            frame f1 at [-0.666, 0.291, 0.631] m,
            frame f2 at [0.0, 0.0, -0.837] m,
        }
        joint free0: free from world to link0.com;
        body link1 {
            mass: 7.0323 kg,
            inertia: full {
                xx: 2.048,
                yy: 2.516,
                zz: 2.714,
                xy: 0.199,
                xz: 0.039,
                yz: 0.035,
            } kg*m^2 (matrix elements),
            frame f0 at [-0.206, -0.122, -0.493] m,
            frame f1 at [0.087, 0.496, 0.636] m,
            frame f2 at [0.724, 0.416, -0.527] m,
        }
        joint free1: free from world to link1.com;
        body link2 {
            mass: C1,
            inertia: diag(2.324, 2.159, 2.894) kg*m^2,
            frame f0 at [0.0, 0.0, -0.349] m,
            frame f1 at [-0.213, -0.825, 0.214] m,
            frame f2 at [0.917, 0.751, 0.053] m,
        }
        joint free2: free from world to link2.com;
        world {
            frame anchor0 at [2.019, 0.273, 1.763] m,
            frame anchor1 at [-1.761, -3.701, -3.824] m,
            frame anchor2 at [0.548, -3.040, -2.706] m,
        }
        line plain0 from link1.f0 to link0.f2 { free_length: 0.3963 m, stiffness: C2 }
        load drag0 on link0 at f0 = -(p3) * norm(link0.f0.velocity) * link0.f0.velocity;
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        output tilt1 = angle(link1.z, world.z);
        output tip1 = link1.f1.position;
        load couple2 on link2 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link2.x, [0.0, 0.0, 2.0] N*m);
        output tilt2 = angle(link2.z, world.z);
        output tip2 = link2.f1.position;
        param p0 = 48.5791 kg in 24.2896 kg ..= 97.1583 kg;
        const C1 = 43.5765 kg;
        const C2 = 4314.7602 N/m;
        param p3 = 1.7856 kg/m in 0.8928 kg/m ..= 3.5712 kg/m;
    }
}

mbd_runtime::model! {
    pub model Random2<T> {
        angular_velocity: body;
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        body link0 {
            mass: 30.1863 kg,
            inertia: full {
                xx: 2.312,
                yy: 2.347,
                zz: 2.726,
                xy: -0.100,
                xz: 0.091,
                yz: -0.064,
            } kg*m^2 (matrix elements),
            frame f0 at [-0.124, 0.112, -0.252] m,
            frame f1 at [-0.593, -0.600, -0.272] m,
            frame f2 at [0.0, 0.0, 0.055] m,
        }
        joint free0: free from world to link0.com;
        body link1 {
            mass: C0,
            inertia: full {
                xx: 2.740,
                yy: 2.525,
                zz: 2.620,
                xy: -0.080,
                xz: 0.147,
                yz: 0.041,
            } kg*m^2 (matrix elements),
            frame f0 at [-0.466, -0.314, 0.767] m,
            frame f1 at [0.0, 0.0, 0.804] m,
            frame f2 at [0.0, 0.0, -0.984] m,
        }
        joint free1: free from world to link1.com;
        world {
            frame anchor0 at [2.710, -0.510, 3.837] m,
            frame anchor1 at [2.808, -2.598, 0.397] m,
            frame anchor2 at [-0.231, 2.013, -1.458] m,
        }
        line plain0 from link1.f2 to world.anchor1 { free_length: C1, stiffness: 928.0638 N/m }
        point knot0 { equilibrium: stepwise }
        line leg0_0 from knot0 to link0.f2 { free_length: p3, stiffness: C2, damping: C4 }
        line leg0_1 from knot0 to world.anchor0 {
            free_length: 1.1880 m,
            stiffness: 2194.3792 N/m,
            damping: p5,
        }
        line leg0_2 from world.anchor1 to knot0 {
            free_length: p7,
            stiffness: p6,
            damping: 38.2252 N*s/m,
        }
        line leg0_3 from world.anchor0 to knot0 { free_length: C9, stiffness: C8, damping: p10 }
        load drag0 on link0 at f0 = -(C11) * norm(link0.f0.velocity) * link0.f0.velocity;
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        output tilt1 = angle(link1.z, world.z);
        output tip1 = link1.f1.position;
        const C0 = 17.2037 kg;
        const C1 = 0.8598 m;
        const C2 = 2949.3403 N/m;
        param p3 = 0.6438 m in 0.3219 m ..= 1.2877 m;
        const C4 = 26.7414 N*s/m;
        param p5 = 40.8275 N*s/m in 20.4137 N*s/m ..= 81.6550 N*s/m;
        param p6 = 1594.2318 N/m in 797.1159 N/m ..= 3188.4635 N/m;
        param p7 = 1.9364 m in 0.9682 m ..= 3.8727 m;
        const C8 = 1984.5568 N/m;
        const C9 = 1.0149 m;
        param p10 = 28.7894 N*s/m in 14.3947 N*s/m ..= 57.5789 N*s/m;
        const C11 = 1.4205 kg/m;
    }
}

mbd_runtime::model! {
    pub model Random3<T> {
        angular_velocity: world;
        gravity: [0.3, -0.2, -9.81] m/s^2;
        body link0 {
            mass: p0,
            inertia: diag(2.216, 2.636, 2.135) kg*m^2,
            frame f0 at [0.0, 0.0, 0.397] m,
            frame f1 at [0.0, 0.0, 0.435] m,
            frame f2 at [-0.388, -0.792, -0.654] m,
        }
        joint free0: free from world to link0.com;
        world {
            frame anchor0 at [2.555, 3.486, 1.357] m,
            frame anchor1 at [-2.471, 0.979, 3.121] m,
            frame anchor2 at [-2.274, -3.033, 1.130] m,
        }
        point ball0 { mass: 3.5368 kg }
        point ball1 { mass: p1 }
        line plain0 from link0.f2 to world.anchor0 {
            free_length: 1.1144 m,
            stiffness: 1911.4769 N/m,
            damping: C2,
        }
        line plain1 from link0.f1 to world.anchor1 {
            free_length: C3,
            stiffness: 3514.5278 N/m,
            damping: p4,
        }
        line plain2 from world.anchor1 to ball1 { free_length: C6, stiffness: C5 }
        point knot0 { equilibrium: rate }
        line leg0_0 from knot0 to link0.f1 {
            free_length: C7,
            stiffness: 2844.6994 N/m,
            damping: C8,
        }
        line leg0_1 from ball1 to knot0 { free_length: p9, stiffness: 4027.8931 N/m, damping: C10 }
        line leg0_2 from knot0 to ball0 { free_length: C12, stiffness: p11, damping: 19.9093 N*s/m }
        line leg0_3 from knot0 to link0.f2 {
            free_length: 1.8001 m,
            stiffness: 4352.7308 N/m,
            damping: p13,
        }
        line leg0_4 from world.anchor1 to knot0 {
            free_length: 0.8014 m,
            stiffness: 2940.1190 N/m,
            damping: C14,
        }
        load couple0 on link0 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link0.x, [0.0, 0.0, 2.0] N*m);
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        param p0 = 31.0358 kg in 15.5179 kg ..= 62.0715 kg;
        param p1 = 1.1073 kg in 0.5536 kg ..= 2.2145 kg;
        const C2 = 42.9593 N*s/m;
        const C3 = 1.1729 m;
        param p4 = 21.9495 N*s/m in 10.9748 N*s/m ..= 43.8991 N*s/m;
        const C5 = 2134.9860 N/m;
        const C6 = 0.8762 m;
        const C7 = 0.7979 m;
        const C8 = 26.3327 N*s/m;
        param p9 = 0.7797 m in 0.3898 m ..= 1.5594 m;
        const C10 = 36.1696 N*s/m;
        param p11 = 2040.3220 N/m in 1020.1610 N/m ..= 4080.6441 N/m;
        const C12 = 1.9351 m;
        param p13 = 33.2197 N*s/m in 16.6098 N*s/m ..= 66.4393 N*s/m;
        const C14 = 49.2486 N*s/m;
    }
}

mbd_runtime::model! {
    pub model Random4<T> {
        angular_velocity: body;
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        world {
            frame anchor0 at [2.873, -0.066, -0.843] m,
            frame anchor1 at [0.694, 3.365, -0.410] m,
            frame anchor2 at [-2.546, 0.301, 2.352] m,
        }
        point knot0 { equilibrium: rate }
        line leg0_0 from world.anchor0 to knot0 {
            free_length: 0.8589 m,
            stiffness: C0,
            damping: p1,
        }
        line leg0_1 from knot0 to world.anchor1 {
            free_length: 0.6495 m,
            stiffness: 2864.5162 N/m,
            damping: C2,
        }
        line leg0_2 from knot0 to world.anchor1 {
            free_length: C4,
            stiffness: C3,
            damping: 42.1324 N*s/m,
        }
        line leg0_3 from world.anchor0 to knot0 {
            free_length: 0.4911 m,
            stiffness: p5,
            damping: C6,
        }
        const C0 = 3831.3192 N/m;
        param p1 = 31.0718 N*s/m in 15.5359 N*s/m ..= 62.1436 N*s/m;
        const C2 = 46.8646 N*s/m;
        const C3 = 4446.1095 N/m;
        const C4 = 1.3043 m;
        param p5 = 112.7565 N/m in 56.3783 N/m ..= 225.5131 N/m;
        const C6 = 48.4095 N*s/m;
    }
}

mbd_runtime::model! {
    pub model Random5<T> {
        angular_velocity: world;
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        world {
            frame anchor0 at [-2.138, -3.205, -2.496] m,
            frame anchor1 at [-0.955, 3.885, 0.089] m,
            frame anchor2 at [-0.588, 0.828, -0.396] m,
        }
        point ball0 { mass: p0 }
        spring plain0 from world.anchor2 to ball0 { free_length: 1.9774 m, stiffness: p1 }
        line plain1 from ball0 to world.anchor2 { free_length: p2, stiffness: 4236.9000 N/m }
        line plain2 from world.anchor2 to ball0 { free_length: p4, stiffness: p3, damping: C5 }
        param p0 = 4.3964 kg in 2.1982 kg ..= 8.7928 kg;
        param p1 = 2330.6365 N/m in 1165.3182 N/m ..= 4661.2729 N/m;
        param p2 = 0.5500 m in 0.2750 m ..= 1.1001 m;
        param p3 = 2294.6522 N/m in 1147.3261 N/m ..= 4589.3044 N/m;
        param p4 = 0.2030 m in 0.1015 m ..= 0.4061 m;
        const C5 = 31.8164 N*s/m;
    }
}

mbd_runtime::model! {
    pub model Random6<T> {
        angular_velocity: body;
        gravity: none;
        body link0 {
            mass: 3.7608 kg,
            inertia: diag(2.551, 2.824, 2.193) kg*m^2,
            frame f0 at [0.0, 0.0, -0.751] m,
            frame f1 at [-0.602, 0.775, -0.181] m,
            frame f2 at [0.230, 0.024, 0.805] m,
        }
        joint free0: free from world to link0.com;
        world {
            frame anchor0 at [3.968, 1.318, 1.369] m,
            frame anchor1 at [-3.907, -1.474, -0.632] m,
            frame anchor2 at [0.868, 1.714, 3.313] m,
        }
        point ball0 { mass: p0 }
        point ball1 { mass: C1 }
        line plain0 from ball1 to world.anchor2 {
            free_length: 0.6058 m,
            stiffness: p2,
            damping: p3,
        }
        line plain1 from link0.f0 to world.anchor1 {
            free_length: C5,
            stiffness: C4,
            damping: 23.0713 N*s/m,
        }
        spring plain2 from link0.f0 to world.anchor0 {
            free_length: 0.5777 m,
            stiffness: 1290.1324 N/m,
            damping: 37.2902 N*s/m,
        }
        point knot0 { equilibrium: stepwise }
        line leg0_0 from link0.f0 to knot0 { free_length: p7, stiffness: p6, damping: p8 }
        line leg0_1 from ball1 to knot0 { free_length: p10, stiffness: p9, damping: C11 }
        line leg0_2 from knot0 to world.anchor2 {
            free_length: C12,
            stiffness: 2194.8141 N/m,
            damping: C13,
        }
        line leg0_3 from ball1 to knot0 { free_length: p15, stiffness: C14, damping: p16 }
        load couple0 on link0 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link0.x, [0.0, 0.0, 2.0] N*m);
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        param p0 = 2.8409 kg in 1.4204 kg ..= 5.6817 kg;
        const C1 = 4.7605 kg;
        param p2 = 2571.0449 N/m in 1285.5224 N/m ..= 5142.0897 N/m;
        param p3 = 40.4254 N*s/m in 20.2127 N*s/m ..= 80.8508 N*s/m;
        const C4 = 4432.6055 N/m;
        const C5 = 0.8215 m;
        param p6 = 3845.1208 N/m in 1922.5604 N/m ..= 7690.2415 N/m;
        param p7 = 0.3566 m in 0.1783 m ..= 0.7132 m;
        param p8 = 18.8354 N*s/m in 9.4177 N*s/m ..= 37.6708 N*s/m;
        param p9 = 3811.7263 N/m in 1905.8631 N/m ..= 7623.4525 N/m;
        param p10 = 1.3325 m in 0.6663 m ..= 2.6650 m;
        const C11 = 12.6142 N*s/m;
        const C12 = 1.0266 m;
        const C13 = 26.6924 N*s/m;
        const C14 = 2819.2974 N/m;
        param p15 = 0.6524 m in 0.3262 m ..= 1.3048 m;
        param p16 = 49.1341 N*s/m in 24.5671 N*s/m ..= 98.2683 N*s/m;
    }
}

mbd_runtime::model! {
    pub model Random7<T> {
        angular_velocity: world;
        gravity: oblate {
            mu: 4.2828e13 m^3/s^2,
            center: [1000.0, 0.0, -3404590.0] m,
            radius: 3396190.0 m,
            j2: 0.00196,
            axis: [0.6, 0.0, 0.8],
        };
        world {
            frame anchor0 at [3.206, 0.663, -0.380] m,
            frame anchor1 at [-2.005, -0.256, -1.375] m,
            frame anchor2 at [-2.926, -0.695, -3.172] m,
        }
        point ball0 { mass: C0 }
        line plain0 from world.anchor0 to ball0 { free_length: p2, stiffness: C1 }
        spring plain1 from ball0 to world.anchor0 {
            free_length: C3,
            stiffness: 2094.5158 N/m,
            damping: 3.6578 N*s/m,
        }
        const C0 = 4.6065 kg;
        const C1 = 3810.8777 N/m;
        param p2 = 0.3920 m in 0.1960 m ..= 0.7841 m;
        const C3 = 0.9471 m;
    }
}

mbd_runtime::model! {
    pub model Random8<T> {
        angular_velocity: body;
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        body link0 {
            mass: C0,
            inertia: diag(2.064, 2.375, 2.954) kg*m^2,
            frame f0 at [-0.840, -0.126, 0.252] m,
            frame f1 at [0.0, 0.0, 0.368] m,
            frame f2 at [-0.993, -0.883, 0.770] m,
        }
        joint free0: free from world to link0.com;
        world {
            frame anchor0 at [2.763, -2.926, -1.198] m,
            frame anchor1 at [-0.785, 3.960, -1.927] m,
            frame anchor2 at [-3.540, -2.153, 2.392] m,
        }
        point ball0 { mass: p1 }
        line plain0 from ball0 to link0.f1 { free_length: p3, stiffness: p2 }
        spring plain1 from ball0 to link0.f0 {
            free_length: C4,
            stiffness: 3957.4125 N/m,
            damping: p5,
        }
        line plain2 from world.anchor2 to link0.f0 { free_length: p7, stiffness: C6 }
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        const C0 = 34.7624 kg;
        param p1 = 2.5874 kg in 1.2937 kg ..= 5.1749 kg;
        param p2 = 3129.8905 N/m in 1564.9452 N/m ..= 6259.7810 N/m;
        param p3 = 0.9391 m in 0.4695 m ..= 1.8782 m;
        const C4 = 0.6542 m;
        param p5 = 37.2654 N*s/m in 18.6327 N*s/m ..= 74.5307 N*s/m;
        const C6 = 1262.4599 N/m;
        param p7 = 0.8973 m in 0.4486 m ..= 1.7945 m;
    }
}

mbd_runtime::model! {
    pub model Random9<T> {
        angular_velocity: world;
        gravity: none;
        body link0 {
            mass: 14.0008 kg,
            inertia: full {
                xx: 2.263,
                yy: 2.115,
                zz: 2.646,
                xy: -0.112,
                xz: 0.116,
                yz: 0.036,
            } kg*m^2 (matrix elements),
            frame f0 at [-0.570, 0.972, -0.519] m,
            frame f1 at [0.772, 0.131, -0.606] m,
            frame f2 at [0.353, 0.533, -0.838] m,
        }
        joint free0: free from world to link0.com;
        body link1 {
            mass: 19.3201 kg,
            inertia: diag(2.668, 2.961, 2.259) kg*m^2,
            frame f0 at [0.405, -0.385, -0.998] m,
            frame f1 at [0.707, -0.787, 0.839] m,
            frame f2 at [0.0, 0.0, 0.740] m,
        }
        joint free1: free from world to link1.com;
        world {
            frame anchor0 at [-0.608, -0.663, -3.593] m,
            frame anchor1 at [1.474, 2.628, -2.134] m,
            frame anchor2 at [-3.096, -0.315, -3.408] m,
        }
        point ball0 { mass: 2.1936 kg }
        line plain0 from world.anchor0 to link1.f2 { free_length: C1, stiffness: p0, damping: C2 }
        line plain1 from world.anchor0 to ball0 {
            free_length: 1.8974 m,
            stiffness: p3,
            damping: C4,
        }
        line plain2 from link1.f2 to world.anchor1 {
            free_length: p6,
            stiffness: p5,
            damping: 2.7889 N*s/m,
        }
        point knot0 { equilibrium: stepwise }
        line leg0_0 from knot0 to link1.f1 {
            free_length: p8,
            stiffness: C7,
            damping: 20.9733 N*s/m,
        }
        line leg0_1 from knot0 to link1.f1 {
            free_length: 0.9195 m,
            stiffness: 2553.9427 N/m,
            damping: 21.0885 N*s/m,
        }
        line leg0_2 from knot0 to link0.f1 { free_length: 0.7046 m, stiffness: p9, damping: p10 }
        load couple0 on link0 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link0.x, [0.0, 0.0, 2.0] N*m);
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        load couple1 on link1 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link1.x, [0.0, 0.0, 2.0] N*m);
        output tilt1 = angle(link1.z, world.z);
        output tip1 = link1.f1.position;
        param p0 = 2582.3176 N/m in 1291.1588 N/m ..= 5164.6353 N/m;
        const C1 = 0.4609 m;
        const C2 = 11.3903 N*s/m;
        param p3 = 3503.2237 N/m in 1751.6119 N/m ..= 7006.4474 N/m;
        const C4 = 45.2745 N*s/m;
        param p5 = 4815.0404 N/m in 2407.5202 N/m ..= 9630.0807 N/m;
        param p6 = 0.2204 m in 0.1102 m ..= 0.4407 m;
        const C7 = 1006.8904 N/m;
        param p8 = 1.8556 m in 0.9278 m ..= 3.7112 m;
        param p9 = 1290.5458 N/m in 645.2729 N/m ..= 2581.0916 N/m;
        param p10 = 10.1741 N*s/m in 5.0871 N*s/m ..= 20.3482 N*s/m;
    }
}

mbd_runtime::model! {
    pub model Random10<T> {
        angular_velocity: body;
        gravity: point_mass { mu: 4.2828e13 m^3/s^2, center: [0.0, 0.0, -3404590.0] m };
        body link0 {
            mass: C0,
            inertia: full {
                xx: 2.856,
                yy: 2.949,
                zz: 2.787,
                xy: 0.189,
                xz: -0.083,
                yz: -0.104,
            } kg*m^2 (matrix elements),
            frame f0 at [-0.423, -0.997, 0.799] m,
            frame f1 at [-0.415, -0.554, 0.838] m,
            frame f2 at [0.0, 0.0, 0.163] m,
        }
        joint free0: free from world to link0.com;
        body link1 {
            mass: p1,
            inertia: diag(2.412, 2.470, 2.134) kg*m^2,
            frame f0 at [0.207, -0.148, 0.851] m,
            frame f1 at [0.0, 0.0, -0.094] m,
            frame f2 at [0.334, 0.151, -0.165] m,
        }
        joint free1: free from world to link1.com;
        world {
            frame anchor0 at [-0.907, -2.273, -3.037] m,
            frame anchor1 at [0.213, 0.080, -2.782] m,
            frame anchor2 at [-0.589, 1.823, 2.580] m,
        }
        point ball0 { mass: C2 }
        load drag0 on link0 at f0 = -(1.0140 kg/m) * norm(link0.f0.velocity) * link0.f0.velocity;
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        load couple1 on link1 at com =
            [0.1, sin(time / 1.0 s), 0.3] N*m - cross(link1.x, [0.0, 0.0, 2.0] N*m);
        output tilt1 = angle(link1.z, world.z);
        output tip1 = link1.f1.position;
        const C0 = 7.4177 kg;
        param p1 = 43.3302 kg in 21.6651 kg ..= 86.6604 kg;
        const C2 = 0.5686 kg;
    }
}

mbd_runtime::model! {
    pub model Random11<T> {
        angular_velocity: world;
        gravity: [0.3, -0.2, -9.81] m/s^2;
        body link0 {
            mass: p0,
            inertia: diag(2.165, 2.552, 2.101) kg*m^2,
            frame f0 at [-0.319, 0.914, -0.672] m,
            frame f1 at [0.823, 0.942, 0.904] m,
            frame f2 at [0.220, 0.821, 0.437] m,
        }
        joint free0: free from world to link0.com;
        world {
            frame anchor0 at [-2.580, 2.511, 2.074] m,
            frame anchor1 at [-0.354, 1.239, 3.447] m,
            frame anchor2 at [2.878, 1.984, -0.893] m,
        }
        point ball0 { mass: p1 }
        line plain0 from link0.f0 to ball0 { free_length: 0.7617 m, stiffness: 3381.2267 N/m }
        spring plain1 from link0.f1 to ball0 { free_length: C3, stiffness: p2, damping: p4 }
        spring plain2 from link0.f2 to world.anchor1 { free_length: C6, stiffness: C5 }
        point knot0 { equilibrium: static }
        line leg0_0 from world.anchor2 to knot0 { free_length: p8, stiffness: p7 }
        line leg0_1 from knot0 to ball0 { free_length: p10, stiffness: C9 }
        line leg0_2 from knot0 to link0.f1 { free_length: 0.7085 m, stiffness: 2638.4666 N/m }
        point twin0 { equilibrium: static }
        line tie0 from knot0 to twin0 { free_length: C12, stiffness: C11 }
        line twig0_0 from twin0 to world.anchor0 { free_length: C14, stiffness: C13 }
        line twig0_1 from twin0 to world.anchor0 { free_length: p15, stiffness: 2185.1399 N/m }
        load drag0 on link0 at f0 = -(p16) * norm(link0.f0.velocity) * link0.f0.velocity;
        output tilt0 = angle(link0.z, world.z);
        output tip0 = link0.f1.position;
        param p0 = 32.2641 kg in 16.1320 kg ..= 64.5281 kg;
        param p1 = 3.2750 kg in 1.6375 kg ..= 6.5501 kg;
        param p2 = 2764.9747 N/m in 1382.4874 N/m ..= 5529.9494 N/m;
        const C3 = 1.3709 m;
        param p4 = 27.2728 N*s/m in 13.6364 N*s/m ..= 54.5457 N*s/m;
        const C5 = 4382.6752 N/m;
        const C6 = 1.0587 m;
        param p7 = 2956.3046 N/m in 1478.1523 N/m ..= 5912.6093 N/m;
        param p8 = 0.9995 m in 0.4997 m ..= 1.9990 m;
        const C9 = 4813.8389 N/m;
        param p10 = 0.7256 m in 0.3628 m ..= 1.4512 m;
        const C11 = 1635.8338 N/m;
        const C12 = 1.2687 m;
        const C13 = 1983.6498 N/m;
        const C14 = 0.9190 m;
        param p15 = 0.9477 m in 0.4738 m ..= 1.8953 m;
        param p16 = 1.2275 kg/m in 0.6137 kg/m ..= 2.4550 kg/m;
    }
}
