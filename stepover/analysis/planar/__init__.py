"""The planar biped of Sec. II-A and its feasibility domains, Fig. 2. No motion is planned with it; it shows why."""
