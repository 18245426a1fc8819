"""The planar biped of Sec. II-A and its feasibility domains, Fig. 2. It explains the method; no planner uses it."""
