//! States by the names of the declaration.

use mbd_runtime::{BodyState, Model, PointState, model, state_names};

model! {
    /// A leader, three followers and two balls; one body has the name of a function of every state.
    pub model Fleet<T> {
        gravity: none;
        body lead { mass: 1.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
        body wing[i in 1..4] { mass: 1.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
        body to_vec { mass: 1.0 kg, inertia: diag(1.0, 1.0, 1.0) kg*m^2 }
        point ball[i in 0..2] { mass: 0.1 kg }
        point last { mass: 0.1 kg }
        joint lead_free: free from world to lead.com;
        joint wing_free[i in 1..4]: free from world to wing[i].com;
        joint other_free: free from world to to_vec.com;
    }
}

/// The places in x of everything that belongs to a name.
fn places(model: &Fleet, name: &str) -> Vec<usize> {
    let names = state_names(model.scene(), model.layout());
    let own = |column: &str| {
        column
            .strip_prefix(name)
            .is_some_and(|rest| rest.starts_with('.'))
    };
    let all = names.iter().enumerate();
    all.filter(|(_, column)| own(&column.name))
        .map(|(place, _)| place)
        .collect()
}

#[test]
fn a_part_is_put_where_the_columns_of_its_name_are_and_read_back() {
    let model = Fleet::new(Default::default()).expect("no params");
    let body = BodyState {
        position: [1.0, 2.0, 3.0],
        orientation: [0.5, 0.5, -0.5, 0.5],
        velocity: [4.0, 5.0, 6.0],
        angular_velocity: [7.0, 8.0, 9.0],
    };
    let point = PointState {
        position: [1.5, 2.5, 3.5],
        velocity: [4.5, 5.5, 6.5],
    };
    let rest: FleetState = FleetState::at_origin();
    let changed = |state: &FleetState| -> Vec<usize> {
        let (x, rest) = (state.to_vec(), rest.to_vec());
        (0..x.len())
            .filter(|&place| x[place] != rest[place])
            .collect()
    };
    let mut state = rest.clone();
    state.set_lead(body);
    assert_eq!(
        (state.lead(), changed(&state)),
        (body, places(&model, "lead"))
    );
    for index in 1..4 {
        let mut state = rest.clone();
        assert_eq!(state.set_wing(index, body), Some(()));
        assert_eq!(state.wing(index), Some(body));
        assert_eq!(changed(&state), places(&model, &format!("wing[{index}]")));
    }
    for index in 0..2 {
        let mut state = rest.clone();
        assert_eq!(state.set_ball(index, point), Some(()));
        assert_eq!(state.ball(index), Some(point));
        assert_eq!(changed(&state), places(&model, &format!("ball[{index}]")));
    }
    let mut state = rest.clone();
    state.set_last(point);
    assert_eq!(
        (state.last(), changed(&state)),
        (point, places(&model, "last"))
    );
}

#[test]
fn a_member_that_is_not_there_is_none_and_nothing_changes() {
    let rest: FleetState<f32> = FleetState::at_origin();
    let mut state = rest.clone();
    for index in [0, 4, usize::MAX] {
        assert_eq!(state.wing(index), None);
        assert_eq!(state.set_wing(index, BodyState::at([1.0; 3])), None);
    }
    assert_eq!(state, rest);
    assert_eq!(rest.wing(3), Some(BodyState::at([0.0; 3])));
}
