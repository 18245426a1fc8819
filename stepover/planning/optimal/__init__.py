"""The optimising planner: stepping over an obstacle as one optimal control problem.

minimise over x
    1/2 |accelerations of all channels|^2 + 1/2 |deviations from a base motion|^2
    + 1/2 |ZMP off the middle of the sole|^2 + 1/2 |moment about the vertical|^2
subject to, at all samples of 5 ms,
    q_min <= q <= q_max, abs(dq/dt) <= r_v dq_max                     constraints/joints.py
    abs(RNEA(q, dq/dt, d2q/dt2) - sum J' w) <= r_t tau_max            constraints/torque.py, sharing.py
    hip to ankle <= length of a leg with a bent knee                  constraints/reach.py
    ZMP inside the soles, friction, vertical force, yaw moment        constraints/contact.py
    distance of all links from the obstacle with its margins >= 0     constraints/obstacle.py
    distances between legs, arms, trunk and thighs >= 0               constraints/own_links.py
    soles above the floor, braking before they touch down             constraints/floor.py
    small roll and pitch of the waist                                 constraints/waist.py

The variables x are coefficients of B-splines: how far waist, soles, chest and arms deviate from a base motion, where
the feet stand and how they turn, and where the obstacle is met (variables.py). The deviations vanish outside the steps
over the obstacle, with speed and acceleration, so the motion begins and ends inside Algorithm 1's walk and the robot
never stops. The legs follow by inverse kinematics (channels.py), and forces by inverse dynamics (instants.py).

The problem is solved by sequential quadratic programming (sqp.py, qp.py), from the base motion (base.py) or along a
chain of lower and narrower obstacles (search.py). All reserves and weights are the same for every obstacle
(model/parameters/optimal.py).
"""
